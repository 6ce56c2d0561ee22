//! The files of the phone page, embedded in the program.

/// The path of the page, relative to the token.
pub const PAGE_PATH: &str = "";
/// The path of the WebSocket, relative to the token.
pub const SESSION_PATH: &str = "hands";

/// The prefix of a preview image's path, relative to the token. The scene's title follows.
pub(crate) const PICTURE_PATH: &str = "picture/";

#[derive(Debug, PartialEq, Eq)]
pub(crate) struct Asset {
    path: &'static str,
    pub kind: &'static str,
    pub text: &'static str,
}

const ASSETS: [Asset; 3] = [
    Asset { path: PAGE_PATH, kind: "text/html; charset=utf-8", text: include_str!("../page/index.html") },
    Asset { path: "style.css", kind: "text/css; charset=utf-8", text: include_str!("../page/style.css") },
    Asset { path: "page.js", kind: "text/javascript; charset=utf-8", text: include_str!("../page/page.js") },
];

pub(crate) fn asset(path: &str) -> Option<&'static Asset> {
    ASSETS.iter().find(|asset| asset.path == path)
}

/// Returns the HTML of the page, for tests.
pub fn page_text() -> &'static str {
    ASSETS[0].text
}

/// Returns the page's content security policy: only its own style, script and images, and connections to `host`.
pub(crate) fn policy(host: &str) -> String {
    // Some browsers do not include WebSockets in 'self'.
    format!(
        "default-src 'none'; style-src 'self'; script-src 'self'; connect-src 'self' ws://{host}; img-src 'self' data:; \
         base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_loads_no_external_files_and_has_no_inline_script() {
        for asset in &ASSETS {
            for elsewhere in ["http:", "https:", "url(", "@import", "import(", "src=\"/", "eval("] {
                assert!(!asset.text.contains(elsewhere), "{} contains {elsewhere}", asset.path);
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
    fn show_texts_are_never_inserted_as_markup() {
        let script = asset("page.js").unwrap().text;
        for markup in ["innerHTML", "outerHTML", "insertAdjacentHTML", "document.write"] {
            assert!(!script.contains(markup), "{markup}");
        }
    }
}
