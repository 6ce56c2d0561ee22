//! What is answered: the page, its style and its script, all of them part of the program.

/// Where the page is, behind the token.
pub const PAGE_PATH: &str = "";
/// Where the WebSocket is, behind the token.
pub const SESSION_PATH: &str = "hands";

/// What the path of a scene's picture begins with, behind the token; the scene's title follows.
pub(crate) const PICTURE_PATH: &str = "picture/";

/// One text that is answered.
#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Asset {
    path: &'static str,
    pub kind: &'static str,
    pub text: &'static str,
}

/// All of them.
const ASSETS: [Asset; 3] = [
    Asset { path: PAGE_PATH, kind: "text/html; charset=utf-8", text: include_str!("../page/index.html") },
    Asset { path: "style.css", kind: "text/css; charset=utf-8", text: include_str!("../page/style.css") },
    Asset { path: "page.js", kind: "text/javascript; charset=utf-8", text: include_str!("../page/page.js") },
];

/// The one of this path behind the token.
pub(crate) fn asset(path: &str) -> Option<&'static Asset> {
    ASSETS.iter().find(|asset| asset.path == path)
}

/// The page itself, for tests of what it asks for.
pub fn page_text() -> &'static str {
    ASSETS[0].text
}

/// What a browser may do with the page: show it with its own style, script and pictures, and speak with the host that it came from.
pub(crate) fn policy(host: &str) -> String {
    // Some browsers do not count a socket among what is the page's own.
    format!(
        "default-src 'none'; style-src 'self'; script-src 'self'; connect-src 'self' ws://{host}; img-src 'self' data:; \
         base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_takes_nothing_from_elsewhere_and_holds_no_script_of_its_own() {
        for asset in &ASSETS {
            for elsewhere in ["http:", "https:", "url(", "@import", "import(", "src=\"/", "eval("] {
                assert!(!asset.text.contains(elsewhere), "{} holds {elsewhere}", asset.path);
            }
        }
        let page = page_text();
        assert_eq!(page.matches("<script").count(), 1);
        assert!(
            page.contains("<script src=\"page.js\"")
                && !page.contains("style=\"")
                && !page.contains(" onclick")
        );
        for path in ["style.css", "page.js"] {
            assert!(page.contains(&format!("\"{path}\"")) && asset(path).is_some());
        }
    }

    #[test]
    fn texts_of_a_show_become_no_markup() {
        let script = asset("page.js").unwrap().text;
        for markup in ["innerHTML", "outerHTML", "insertAdjacentHTML", "document.write"] {
            assert!(!script.contains(markup), "{markup}");
        }
    }
}
