//! Text that a browser reads as HTML.

/// HTML that is being written. Markup can only be a constant of this program, and everything else is escaped.
#[derive(Debug, Default)]
pub(crate) struct Html(String);

impl Html {
    /// Markup.
    pub(crate) fn raw(&mut self, markup: &'static str) -> &mut Self {
        self.0.push_str(markup);
        self
    }

    /// Text, between tags or in the quotes of an attribute.
    pub(crate) fn text(&mut self, text: &str) -> &mut Self {
        for character in text.chars() {
            match character {
                '&' => self.0.push_str("&amp;"),
                '<' => self.0.push_str("&lt;"),
                '>' => self.0.push_str("&gt;"),
                '"' => self.0.push_str("&quot;"),
                '\'' => self.0.push_str("&#39;"),
                // A server-sent event ends at the end of a line, and nothing that is shown has other control characters.
                control if control.is_control() => self.0.push(' '),
                other => self.0.push(other),
            }
        }
        self
    }

    /// An element around a text.
    pub(crate) fn element(&mut self, open: &'static str, text: &str, close: &'static str) -> &mut Self {
        self.raw(open).text(text).raw(close)
    }

    /// A term of a list, and what is said of it.
    pub(crate) fn pair(&mut self, term: &str, text: &str) {
        self.element("<div><dt>", term, "</dt>").element("<dd>", text, "</dd></div>");
    }

    /// A link around a text.
    pub(crate) fn link(&mut self, to: &str, text: &str) -> &mut Self {
        self.raw("<a href=\"").text(to).element("\">", text, "</a>")
    }

    /// What can be chosen, with its label: each has a value, a text, and its language where that is another one.
    pub(crate) fn select<'o>(
        &mut self,
        name: &'static str,
        label: &str,
        chosen: &str,
        options: impl IntoIterator<Item = (&'o str, &'o str, &'o str)>,
    ) {
        self.element("<label class=\"pick\">", label, " <select id=\"");
        self.raw(name).raw("\" name=\"").raw(name).raw("\">");
        for (value, text, lang) in options {
            self.raw("<option value=\"").text(value);
            if !lang.is_empty() {
                self.raw("\" lang=\"").text(lang);
            }
            self.raw(if value == chosen { "\" selected>" } else { "\">" }).element("", text, "</option>");
        }
        self.raw("</select></label>");
    }

    /// What was written so far, on one line.
    pub(crate) fn finish(self) -> String {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_in_a_text_is_markup_or_ends_an_attribute_or_a_line() {
        let mut html = Html::default();
        html.raw("<p title=\"").text("\"'><script>&\r\n\0").raw("\">");
        assert_eq!(html.finish(), "<p title=\"&quot;&#39;&gt;&lt;script&gt;&amp;   \">");
    }
}
