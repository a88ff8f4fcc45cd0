//! The page, as part of the program.

use axum::http::header::{CONTENT_TYPE, HeaderValue};
use axum::response::{IntoResponse, Response};
use rust_embed::RustEmbed;

/// What `scripts/web` built; nothing where it was not run before the program was built.
#[derive(RustEmbed)]
#[folder = "web/dist"]
#[allow_missing = true]
struct Page;

/// The file that a browser asks for first.
const INDEX: &str = "index.html";

/// Said instead of the page.
const NOT_BUILT_IN: &str = "This program was built without its page: run scripts/web, build again.\n\
    What it would show is at /api/run.\n";

/// Whether the page is part of this program.
#[must_use]
pub fn is_built_in() -> bool {
    Page::get(INDEX).is_some()
}

/// The file `name` of the page; none where there is no such file.
pub(super) fn file(name: &str) -> Option<Response> {
    let name = if name.is_empty() { INDEX } else { name };
    let Some(file) = Page::get(name) else {
        return (name == INDEX).then(|| NOT_BUILT_IN.into_response());
    };
    let kind = HeaderValue::from_str(file.metadata.mimetype()).ok()?;
    Some(([(CONTENT_TYPE, kind)], file.data).into_response())
}
