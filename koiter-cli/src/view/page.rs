//! The page itself, bundled from `viewer/` when the program was built (see `build.rs`).

/// What `viewer/src/index.html` consists of.
const HEAD_END: &str = "</head>";
const BODY_END: &str = "</body>";
const STYLE_LINK: &str = "<link rel=\"stylesheet\" href=\"viewer.css\">";
const SCRIPT_LINK: &str = "<script src=\"viewer.js\" defer></script>";

/// The files of the page.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Page {
    html: &'static str,
    pub(crate) script: &'static str,
    pub(crate) style: &'static str,
}

impl Page {
    /// The page that this program holds.
    ///
    /// # Errors
    /// Why it holds none.
    pub(crate) fn bundled() -> Result<Self, &'static str> {
        let page = Self {
            html: include_str!(concat!(env!("OUT_DIR"), "/viewer-page/index.html")),
            script: include_str!(concat!(env!("OUT_DIR"), "/viewer-page/viewer.js")),
            style: include_str!(concat!(env!("OUT_DIR"), "/viewer-page/viewer.css")),
        };
        match page.script.is_empty() {
            true => Err(env!("KOITER_VIEWER_MISSING")),
            false => Ok(page),
        }
    }

    /// The page as one file, with a result as JSON inside.
    pub(super) fn with_data(&self, json: &str) -> String {
        let style = format!("<style>{}</style>", self.style);
        let script = format!(
            "<script type=\"application/json\" id=\"koiter-data\">{json}</script>\n<script>{}</script>",
            self.script
        );
        // A script that stands in the page runs at once: at its end, when the page is there.
        let html = self
            .html
            .replacen(STYLE_LINK, &style, 1)
            .replacen(SCRIPT_LINK, "", 1);
        html.replacen(BODY_END, &format!("{script}\n{BODY_END}"), 1)
    }

    /// The page with the token of its server.
    pub(super) fn html(&self, token: &str) -> String {
        let meta = format!("<meta name=\"koiter-token\" content=\"{token}\">\n{HEAD_END}");
        self.html.replacen(HEAD_END, &meta, 1)
    }
}

#[cfg(test)]
impl Page {
    /// A page for tests, which need no bundle.
    pub(super) const STUB: Self = Self {
        html: "<head><link rel=\"stylesheet\" href=\"viewer.css\"><script src=\"viewer.js\" defer></script></head><body></body>",
        script: "'script'",
        style: "/* style */",
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_holds_everything_and_asks_for_nothing() {
        let html = Page::STUB.with_data("{}");
        let expected = "<head><style>/* style */</style></head><body><script type=\"application/json\" \
            id=\"koiter-data\">{}</script>\n<script>'script'</script>\n</body>";
        assert_eq!(html, expected);
    }

    #[test]
    fn the_real_page_has_what_is_replaced_and_no_script_ends_early() {
        let Ok(page) = Page::bundled() else {
            eprintln!("skipped: built without the viewer");
            return;
        };
        for part in [HEAD_END, BODY_END, STYLE_LINK, SCRIPT_LINK] {
            assert_eq!(page.html.matches(part).count(), 1, "{part}");
        }
        assert!(!page.script.contains("</script") && !page.style.contains("</style"));
    }
}
