//! The page: built by `page/build`, committed, and carried by the program.

use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse as _, Response};
use sha2::{Digest as _, Sha256};
use std::io::Write as _;
use std::sync::LazyLock;

/// One file of the page.
struct Asset {
    kind: &'static str,
    bytes: &'static [u8],
    packed: Vec<u8>,
    tag: String,
}

impl Asset {
    fn new(kind: &'static str, bytes: &'static [u8]) -> Self {
        let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
        // Writing into memory doesn't fail; a page that isn't packed is larger, and no less right.
        let packed = packer.write_all(bytes).and_then(|()| packer.finish());
        Self {
            kind,
            bytes,
            packed: packed.unwrap_or_default(),
            tag: format!("\"{}\"", &crate::hex::hex(&Sha256::digest(bytes))[..16]),
        }
    }

    fn respond(&self, asks: &HeaderMap) -> Response {
        let says = |name, word: &str| {
            let value = asks.get(name).and_then(|v: &HeaderValue| v.to_str().ok());
            value.is_some_and(|value| value.contains(word))
        };
        let tag = HeaderValue::from_str(&self.tag);
        let tag = tag.unwrap_or(HeaderValue::from_static("\"\""));
        let always = [
            (header::ETAG, tag),
            (header::CACHE_CONTROL, HeaderValue::from_static("no-cache")),
            (header::VARY, HeaderValue::from_static("accept-encoding")),
        ];
        if says(header::IF_NONE_MATCH, &self.tag) {
            return (StatusCode::NOT_MODIFIED, always).into_response();
        }
        let kind = [(header::CONTENT_TYPE, self.kind)];
        match says(header::ACCEPT_ENCODING, "gzip") && !self.packed.is_empty() {
            true => {
                let packed = [(header::CONTENT_ENCODING, "gzip")];
                (always, kind, packed, self.packed.clone()).into_response()
            }
            false => (always, kind, self.bytes).into_response(),
        }
    }
}

static HTML: LazyLock<Asset> = LazyLock::new(|| {
    Asset::new(
        "text/html; charset=utf-8",
        include_bytes!("../../page/dist/index.html"),
    )
});
static SCRIPT: LazyLock<Asset> = LazyLock::new(|| {
    Asset::new(
        "text/javascript; charset=utf-8",
        include_bytes!("../../page/dist/app.js"),
    )
});
static STYLE: LazyLock<Asset> = LazyLock::new(|| {
    Asset::new(
        "text/css; charset=utf-8",
        include_bytes!("../../page/dist/app.css"),
    )
});
static ICON: LazyLock<Asset> =
    LazyLock::new(|| Asset::new("image/svg+xml", include_bytes!("../../page/dist/icon.svg")));

pub(super) async fn html(asks: HeaderMap) -> Response {
    HTML.respond(&asks)
}

pub(super) async fn script(asks: HeaderMap) -> Response {
    SCRIPT.respond(&asks)
}

pub(super) async fn style(asks: HeaderMap) -> Response {
    STYLE.respond(&asks)
}

pub(super) async fn icon(asks: HeaderMap) -> Response {
    ICON.respond(&asks)
}
