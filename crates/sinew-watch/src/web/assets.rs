//! Files of the page: built by `page/build`, committed, and embedded in the program.

use axum::http::{HeaderMap, HeaderValue, StatusCode, Uri, header};
use axum::response::{IntoResponse as _, Response};
use sha2::{Digest as _, Sha256};
use std::io::Write as _;
use std::sync::LazyLock;

/// File of the page.
struct Asset {
    kind: &'static str,
    bytes: &'static [u8],
    packed: Vec<u8>,
    tag: String,
}

impl Asset {
    fn new(kind: &'static str, bytes: &'static [u8]) -> Self {
        let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
        // Writing into memory does not fail; an uncompressed file would be larger but valid.
        let packed = packer.write_all(bytes).and_then(|()| packer.finish());
        Self {
            kind,
            bytes,
            packed: packed.unwrap_or_default(),
            tag: format!("\"{}\"", &crate::hex::hex(&Sha256::digest(bytes))[..16]),
        }
    }

    fn respond(&self, headers: &HeaderMap) -> Response {
        let value = |name, word: &str| {
            let value = headers
                .get(name)
                .and_then(|v: &HeaderValue| v.to_str().ok());
            value.is_some_and(|value| value.contains(word))
        };
        let tag = HeaderValue::from_str(&self.tag);
        let tag = tag.unwrap_or(HeaderValue::from_static("\"\""));
        let always = [
            (header::ETAG, tag),
            (header::CACHE_CONTROL, HeaderValue::from_static("no-cache")),
            (header::VARY, HeaderValue::from_static("accept-encoding")),
        ];
        if value(header::IF_NONE_MATCH, &self.tag) {
            return (StatusCode::NOT_MODIFIED, always).into_response();
        }
        let kind = [(header::CONTENT_TYPE, self.kind)];
        match value(header::ACCEPT_ENCODING, "gzip") && !self.packed.is_empty() {
            true => {
                let packed = [(header::CONTENT_ENCODING, "gzip")];
                (always, kind, packed, self.packed.clone()).into_response()
            }
            false => (always, kind, self.bytes).into_response(),
        }
    }
}

/// HTML, script, style and icon of the page.
static ASSETS: LazyLock<[Asset; 5]> = LazyLock::new(|| {
    [
        Asset::new(
            "text/html; charset=utf-8",
            include_bytes!("../../page/dist/index.html"),
        ),
        Asset::new(
            "text/javascript; charset=utf-8",
            include_bytes!("../../page/dist/app.js"),
        ),
        Asset::new(
            "text/javascript; charset=utf-8",
            include_bytes!("../../page/dist/stream.js"),
        ),
        Asset::new(
            "text/css; charset=utf-8",
            include_bytes!("../../page/dist/app.css"),
        ),
        Asset::new("image/svg+xml", include_bytes!("../../page/dist/icon.svg")),
    ]
});

/// Returns a file of the page by its path; every other path returns the page itself.
pub(super) async fn file(uri: Uri, headers: HeaderMap) -> Response {
    let [html, script, stream, style, icon] = &*ASSETS;
    let asset = match uri.path() {
        "/app.js" => script,
        "/stream.js" => stream,
        "/app.css" => style,
        "/icon.svg" | "/favicon.ico" => icon,
        _ => html,
    };
    asset.respond(&headers)
}
