//! The routing of requests: to a page file, an image, a phone session, or a refusal. Reads no clock and no network.

use std::net::SocketAddr;

use percent_encoding::percent_decode_str;

use crate::http::Head;
use crate::page::{Asset, PICTURE_PATH, SESSION_PATH, asset};
use crate::token::AccessToken;

#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Route {
    /// An embedded file, and the host that the request names.
    Text(&'static Asset, String),
    /// A redirect to the page's address with a trailing slash, which relative links need.
    Slash,
    /// The preview image of the scene with this title.
    Picture(String),
    /// A phone session, with the key of the WebSocket handshake.
    PhoneSession(String),
}

/// A refusal: the HTTP status and a message, which contains nothing from the request.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Refusal(pub(crate) &'static str, pub(crate) &'static str);

impl Refusal {
    const METHOD: Self = Self("405 Method Not Allowed", "this page is read-only; send GET");
    const HOST: Self = Self("403 Forbidden", "open the address in Mariana's window, not a host name");
    const NOTHING: Self =
        Self("404 Not Found", "this page does not exist; open the address in Mariana's window");
    pub(crate) const WRONG_TOKEN: Self =
        Self("403 Forbidden", "this address is no longer valid; open the address in Mariana's window");
    const ORIGIN: Self = Self("403 Forbidden", "requests from other pages are refused");
    pub(crate) const TALK_ONLY: Self =
        Self("426 Upgrade Required", "only WebSocket connections are accepted here");
    const UPGRADE: Self = Self("400 Bad Request", "this is not a WebSocket handshake of version 13");
}

/// Returns the path after the token, if the token is right.
fn behind_token<'a>(path: &'a str, token: &AccessToken) -> Result<Option<&'a str>, Refusal> {
    let path = path.split('?').next().unwrap_or_default().trim_start_matches('/');
    let (guess, rest) = path.split_once('/').map_or((path, None), |(guess, rest)| (guess, Some(rest)));
    // Browsers request these paths by themselves, so these paths do not count as wrong tokens.
    if ["", "favicon.ico", "robots.txt"].contains(&guess) {
        return Err(Refusal::NOTHING);
    }
    if !token.is(guess) {
        return Err(Refusal::WRONG_TOKEN);
    }
    Ok(rest)
}

/// Checks the method and the host. Returns the host.
pub(crate) fn admit<'a>(head: &'a Head, own_name: Option<&str>) -> Result<&'a str, Refusal> {
    if head.method != "GET" {
        return Err(Refusal::METHOD);
    }
    head.field("Host").filter(|host| is_this_computer(host, own_name)).ok_or(Refusal::HOST)
}

/// Returns the target of a request with a known host.
pub(crate) fn route(head: &Head, host: &str, token: &AccessToken) -> Result<Route, Refusal> {
    let Some(rest) = behind_token(&head.path, token)? else { return Ok(Route::Slash) };
    if let Some(scene) = rest.strip_prefix(PICTURE_PATH) {
        let title = percent_decode_str(scene).decode_utf8();
        return title.map(|title| Route::Picture(title.into_owned())).map_err(|_| Refusal::NOTHING);
    }
    if rest != SESSION_PATH {
        return asset(rest).map(|asset| Route::Text(asset, host.to_owned())).ok_or(Refusal::NOTHING);
    }
    let says = |name: &str, word: &str| {
        let mut words = head.field(name).unwrap_or_default().split(',');
        words.any(|one| one.trim().eq_ignore_ascii_case(word))
    };
    if !head.has("Upgrade") {
        return Err(Refusal::TALK_ONLY);
    }
    // Browsers send the origin of a page here. A page cannot send a false origin.
    let origin = head.field("Origin").unwrap_or_default();
    if !origin.eq_ignore_ascii_case(&format!("http://{host}")) {
        return Err(Refusal::ORIGIN);
    }
    let key = head.field("Sec-WebSocket-Key").filter(|key| is_key(key));
    match key {
        Some(key)
            if says("Upgrade", "websocket")
                && says("Connection", "upgrade")
                && head.field("Sec-WebSocket-Version") == Some("13") =>
        {
            Ok(Route::PhoneSession(key.to_owned()))
        }
        _ => Err(Refusal::UPGRADE),
    }
}

/// True if the host is an IP address, `localhost`, or the name given by the user. Any other name could belong to an
/// attacker who points it at this computer (DNS rebinding).
fn is_this_computer(host: &str, own_name: Option<&str>) -> bool {
    let is_address = [host, &format!("{host}:80")].iter().any(|host| host.parse::<SocketAddr>().is_ok());
    let with_port = host.rsplit_once(':').filter(|(_, port)| port.parse::<u16>().is_ok());
    let name = with_port.map_or(host, |(name, _)| name);
    let mut own_names = ["localhost"].into_iter().chain(own_name);
    is_address || own_names.any(|own| name.eq_ignore_ascii_case(own))
}

/// True if the text is the base64 encoding of 16 bytes.
fn is_key(key: &str) -> bool {
    let letters = key.strip_suffix("==").unwrap_or_default();
    letters.len() == 22 && letters.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"+/".contains(&byte))
}

#[cfg(test)]
mod tests {
    use super::*;

    const HOST: &str = "192.168.0.7:8080";

    fn head(method: &str, path: &str, fields: &str) -> Head {
        Head::parse(format!("{method} {path} HTTP/1.1\r\n{fields}\r\n").as_bytes(), 16).unwrap().unwrap()
    }

    fn judged(method: &str, path: &str, fields: &str, token: &AccessToken) -> Result<Route, Refusal> {
        let head = head(method, path, fields);
        let host = admit(&head, Some("studio.local"))?;
        route(&head, host, token)
    }

    fn upgrade(host: &str, origin: &str) -> String {
        format!(
            "Host: {host}\r\nOrigin: {origin}\r\nConnection: keep-alive, Upgrade\r\nUpgrade: websocket\r\n\
             Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
        )
    }

    #[test]
    fn the_page_needs_the_token_and_other_paths_are_refused() {
        let token = AccessToken::new().unwrap();
        let ask = |path: &str| judged("GET", path, &format!("Host: {HOST}\r\n"), &token);
        let at = |rest: &str| format!("/{}{rest}", token.as_str());
        assert_eq!([ask(&at("")), ask(&at("?x"))], [Ok(Route::Slash), Ok(Route::Slash)]);
        for path in [at("/"), at("/?x=y"), at("/page.js"), at("/style.css")] {
            assert!(matches!(ask(&path), Ok(Route::Text(_, host)) if host == HOST), "{path}");
        }
        assert_eq!(ask(&at("/hands")), Err(Refusal::TALK_ONLY));
        for path in [at("/../page.js"), at("//etc/passwd"), at("/%2e%2e/x"), at("/page.js/"), at("/x")] {
            assert_eq!(ask(&path), Err(Refusal::NOTHING), "{path}");
        }
        for path in ["/", "/favicon.ico", "//", "/?x", "/robots.txt"] {
            assert_eq!(ask(path), Err(Refusal::NOTHING), "{path}");
        }
        for path in ["/etc/passwd", "/x", "/page.js", "/hands", "/%00", "*", "http://x/"] {
            assert_eq!(ask(path), Err(Refusal::WRONG_TOKEN), "{path}");
        }
    }

    #[test]
    fn images_are_requested_by_scene_title() {
        let token = AccessToken::new().unwrap();
        let ask = |rest: &str| {
            judged(
                "GET",
                &format!("/{}/picture/{rest}", token.as_str()),
                &format!("Host: {HOST}\r\n"),
                &token,
            )
        };
        let is = |title: &str| Ok(Route::Picture(title.to_owned()));
        assert_eq!(ask("orb"), is("orb"));
        assert_eq!(ask("first%5Fsteps?3"), is("first_steps"));
        assert_eq!(ask("gr%C3%B6%C3%9fe"), is("größe"));
        // The decoded text is a title, not a path, and no scene has this title.
        assert_eq!(ask("..%2F..%2fetc/passwd"), is("../../etc/passwd"));
        for rest in ["%", "%4", "%zz", "%+1"] {
            assert_eq!(ask(rest), is(rest), "this is no escape");
        }
        assert_eq!(ask("%ff"), Err(Refusal::NOTHING));
    }

    #[test]
    fn only_get_is_allowed() {
        let token = AccessToken::new().unwrap();
        for method in ["POST", "HEAD", "PUT", "DELETE", "OPTIONS", "get"] {
            let path = format!("/{}/", token.as_str());
            assert_eq!(judged(method, &path, &format!("Host: {HOST}\r\n"), &token), Err(Refusal::METHOD));
        }
    }

    #[test]
    fn unknown_host_names_are_refused() {
        let token = AccessToken::new().unwrap();
        let path = format!("/{}/", token.as_str());
        let ask = |host: &str| judged("GET", &path, &format!("Host: {host}\r\n"), &token);
        for host in
            ["127.0.0.1", "10.0.0.1:80", "localhost:9", "[fe80::1]:8080", "[::1]", "Studio.local:8080"]
        {
            assert!(ask(host).is_ok(), "{host}");
        }
        for host in [
            "example.org",
            "127.0.0.1.example.org",
            "localhost.example.org:80",
            "",
            "10.0.0.1:",
            "[x]",
            "::1",
        ] {
            assert_eq!(ask(host), Err(Refusal::HOST), "{host}");
        }
        assert_eq!(
            judged("GET", &path, "", &token),
            Err(Refusal::HOST),
            "a request without a host is refused"
        );
        assert_eq!(judged("GET", &path, "Host: a\r\nHost: 10.0.0.1\r\n", &token), Err(Refusal::HOST));
        assert_eq!(judged("GET", &path, "Host: 10.0.0.1:8;x\r\n", &token), Err(Refusal::HOST));
    }

    #[test]
    fn only_the_page_itself_can_open_a_session() {
        let token = AccessToken::new().unwrap();
        let path = format!("/{}/hands", token.as_str());
        let ask = |fields: &str| judged("GET", &path, fields, &token);
        let own = format!("http://{HOST}");
        assert_eq!(ask(&upgrade(HOST, &own)), Ok(Route::PhoneSession("dGhlIHNhbXBsZSBub25jZQ==".to_owned())));
        for origin in [
            "http://example.org",
            "null",
            "",
            "http://192.168.0.7",
            "http://192.168.0.7:80801",
            "https://192.168.0.7:8080",
        ] {
            assert_eq!(ask(&upgrade(HOST, origin)), Err(Refusal::ORIGIN), "{origin}");
        }
        let whole = upgrade(HOST, &own);
        assert_eq!(ask(&whole.replace("Origin", "X-Origin")), Err(Refusal::ORIGIN));
        for (part, other) in [
            ("websocket", "h2c"),
            ("keep-alive, Upgrade", "close"),
            ("Version: 13", "Version: 8"),
            ("dGhlIHNhbXBsZSBub25jZQ==", "short=="),
            ("dGhlIHNhbXBsZSBub25jZQ==", "dGhlIHNhbXBsZSBub25j\u{1}Q=="),
        ] {
            // httparse already refuses control characters.
            let fields = whole.replace(part, other);
            let text = format!("GET {path} HTTP/1.1\r\n{fields}\r\n");
            if let Ok(Some(_)) = Head::parse(text.as_bytes(), 16) {
                assert_eq!(ask(&fields), Err(Refusal::UPGRADE), "{other}");
            }
        }
        let wrong = AccessToken::new().unwrap();
        let head = head("GET", &path, &whole);
        assert_eq!(route(&head, HOST, &wrong), Err(Refusal::WRONG_TOKEN), "the token is checked first");
    }
}
