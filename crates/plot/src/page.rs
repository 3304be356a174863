//! A self-contained page for a browser: figures, pictures, tables and texts in one HTML file without scripts. It fits light and dark
//! themes, wide screens and phones.

use crate::canvas::Canvas;
use std::fmt::Write;

/// Content security policy: the page loads nothing and runs nothing.
const POLICY: &str = "default-src 'none'; img-src data:; style-src 'unsafe-inline'";

/// Style sheet. Colors have a contrast of at least 4.5 : 1 on both backgrounds. Drawings, which are made for paper, are inverted on the
/// dark one with their hues kept. Scrolling areas can be reached by keyboard.
const STYLE: &str = "\
:root{color-scheme:light dark;--ink:#1f2328;--dim:#57606a;--ground:#fff;--line:#d5d9de;--panel:#f5f6f8}
@media(prefers-color-scheme:dark){:root{--ink:#e6e8eb;--dim:#a5adb8;--ground:#16181c;--line:#3a3f47;--panel:#1f2227}}
body{margin:0 auto;max-width:72rem;padding:1rem 1.25rem 4rem;background:var(--ground);color:var(--ink);\
font:16px/1.5 system-ui,sans-serif}
h1{font-size:1.6rem;line-height:1.2;margin:.5rem 0}h2{font-size:1.15rem;margin:2rem 0 .5rem}
p{margin:.4rem 0}.dim{color:var(--dim)}
figure{margin:.75rem 0}figure img{display:block;max-width:100%;height:auto}figure.drawn img{background:#fff}
@media(prefers-color-scheme:dark){figure.drawn img{filter:invert(.9) hue-rotate(180deg)}}
figcaption{color:var(--dim);font-size:.875rem;margin-top:.25rem}
.wide{overflow-x:auto;margin:.5rem 0 1.25rem}
table{border-collapse:collapse;font-variant-numeric:tabular-nums}
th,td{text-align:left;vertical-align:top;padding:.2rem 1rem .2rem 0;border-bottom:1px solid var(--line)}
th{font-weight:600}.number{text-align:right}th.name{font-weight:400;color:var(--dim);white-space:nowrap}
pre{background:var(--panel);padding:.75rem 1rem;overflow-x:auto;font-size:.875rem}
a{color:inherit}
@media(max-width:40rem){th,td{padding-right:.6rem}}
";

/// A page that is being written.
#[derive(Clone, Debug)]
pub struct Page {
    title: String,
    body: String,
}

impl Page {
    /// Creates an empty page with a title, which is also its first heading.
    #[must_use]
    pub fn new(title: &str) -> Self {
        Self { title: title.to_owned(), body: format!("<h1>{}</h1>\n", escaped(title)) }
    }

    fn add(&mut self, text: std::fmt::Arguments<'_>) {
        // Writing to a String cannot fail.
        let _ = self.body.write_fmt(text);
    }

    /// Adds a heading to the page.
    pub fn heading(&mut self, text: &str) {
        self.add(format_args!("<h2>{}</h2>\n", escaped(text)));
    }

    /// Adds a paragraph to the page.
    pub fn paragraph(&mut self, text: &str) {
        self.add(format_args!("<p>{}</p>\n", escaped(text)));
    }

    /// Adds a dimmed paragraph with secondary information.
    pub fn aside(&mut self, text: &str) {
        self.add(format_args!("<p class=\"dim\">{}</p>\n", escaped(text)));
    }

    /// Adds a drawing, embedded as SVG, with a caption.
    pub fn figure(&mut self, canvas: &Canvas, caption: &str) {
        let (width, height) = canvas.size();
        let svg = format!("data:image/svg+xml;base64,{}", base64(canvas.to_svg().as_bytes()));
        self.image("drawn", &svg, [width, height], caption);
    }

    /// Adds a picture with a caption. `png` is the content of a PNG file, shown `width` by `height` pixels large, or smaller if there is
    /// less room.
    pub fn picture(&mut self, png: &[u8], [width, height]: [f64; 2], caption: &str) {
        let png = format!("data:image/png;base64,{}", base64(png));
        self.image("shown", &png, [width, height], caption);
    }

    fn image(&mut self, class: &str, source: &str, [width, height]: [f64; 2], caption: &str) {
        let caption = escaped(caption);
        self.add(format_args!(
            "<figure class=\"{class}\"><img src=\"{source}\" width=\"{width:.0}\" height=\"{height:.0}\" alt=\"{caption}\">\
             <figcaption>{caption}</figcaption></figure>\n"
        ));
    }

    /// Adds a table of names and values, one row each.
    pub fn facts(&mut self, rows: &[(String, String)]) {
        self.body.push_str("<div class=\"wide\" tabindex=\"0\"><table>\n");
        for (name, value) in rows {
            self.add(format_args!(
                "<tr><th class=\"name\" scope=\"row\">{}</th><td>{}</td></tr>\n",
                escaped(name),
                escaped(value)
            ));
        }
        self.body.push_str("</table></div>\n");
    }

    /// Adds a table with a header row.
    pub fn table(&mut self, head: &[&str], rows: &[Vec<Cell>]) {
        self.body.push_str("<div class=\"wide\" tabindex=\"0\"><table>\n<tr>");
        for (at, name) in head.iter().enumerate() {
            // Align a column of numbers, with its header, to the right.
            let is_number = rows.first().is_some_and(|row| matches!(row.get(at), Some(Cell::Number(_))));
            let class = if is_number { " class=\"number\"" } else { "" };
            self.add(format_args!("<th scope=\"col\"{class}>{}</th>", escaped(name)));
        }
        self.body.push_str("</tr>\n");
        for row in rows {
            self.body.push_str("<tr>");
            for cell in row {
                match cell {
                    Cell::Text(text) => self.add(format_args!("<td>{}</td>", escaped(text))),
                    Cell::Number(text) => self.add(format_args!("<td class=\"number\">{}</td>", escaped(text))),
                    Cell::Beside(file) => {
                        let name = escaped(file);
                        self.add(format_args!("<td><a href=\"{}\">{name}</a></td>", link(file)));
                    }
                }
            }
            self.body.push_str("</tr>\n");
        }
        self.body.push_str("</table></div>\n");
    }

    /// Adds preformatted text in a monospaced font.
    pub fn text(&mut self, text: &str) {
        self.add(format_args!("<pre tabindex=\"0\">{}</pre>\n", escaped(text)));
    }

    /// Returns the page as an HTML file.
    #[must_use]
    pub fn to_html(&self) -> String {
        format!(
            "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{}</title>\n\
             <style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n{}</main>\n</body>\n</html>\n",
            escaped(&self.title),
            self.body
        )
    }
}

/// A cell of a table on a page.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Cell {
    /// Text, aligned to the left.
    Text(String),
    /// A number, aligned to the right.
    Number(String),
    /// A link to a file in the folder of the page, by its name.
    Beside(String),
}

/// Escapes a text for HTML.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\n' | '\t' => out.push(c),
            // Replace control characters, which HTML does not allow.
            c if c.is_control() => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

/// Returns the name of a file as a relative URL (RFC 3986). It begins with `./`, because a name with a colon would otherwise be read as a
/// URL with a scheme.
fn link(file: &str) -> String {
    let mut out = String::from("./");
    for byte in file.bytes() {
        match byte {
            b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'~' => out.push(char::from(byte)),
            _ => {
                let _ = write!(out, "%{byte:02X}");
            }
        }
    }
    out
}

/// Encodes bytes as base 64 with padding (RFC 4648).
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut out = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let all = three.iter().enumerate().fold(0_u32, |all, (i, byte)| all | u32::from(*byte) << (16 - 8 * i));
        for i in 0..4 {
            let is_there = i <= three.len();
            let letter = LETTERS[(all >> (18 - 6 * i) & 63) as usize];
            out.push(if is_there { char::from(letter) } else { '=' });
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Test vectors of RFC 4648, section 10.
    #[test]
    fn base64_of_the_rfc() {
        for (text, coded) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("fooba", "Zm9vYmE="),
            ("foobar", "Zm9vYmFy"),
        ] {
            assert_eq!(base64(text.as_bytes()), coded);
        }
    }

    #[test]
    fn what_is_written_is_text_and_no_markup() {
        let mut page = Page::new("a < b & \"c\"");
        page.text("</pre><script>alert('x')</script>\u{7}");
        page.table(&["<th>"], &[vec![Cell::Beside("a b:\"<.html".into()), Cell::Number("<1>".into())]]);
        page.facts(&[("<n>".into(), "<v>".into())]);
        let html = page.to_html();
        assert!(html.contains("<h1>a &lt; b &amp; &quot;c&quot;</h1>") && !html.contains("<script"), "{html}");
        assert!(html.contains("href=\"./a%20b%3A%22%3C.html\"") && !html.contains("http://"), "{html}");
        assert!(html.contains("&lt;/pre&gt;") && !html.contains('\u{7}'));
    }
}
