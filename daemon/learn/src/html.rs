//! Pages of the reports: each is one file that needs no other, for light and dark screens.

const STYLE: &str = "body{font:16px/1.5 system-ui,sans-serif;max-width:980px;margin:2rem auto;padding:0 1rem;color:#1f2328;background:#fff}\
h1{font-size:1.6rem}h2{font-size:1.2rem;margin:2.2rem 0 .4rem}h3{font-size:1rem;margin:1.4rem 0 .3rem}\
figure{margin:.6rem 0}figcaption{color:#57606a;font-size:.92rem;max-width:46rem}svg{max-width:100%;height:auto}\
table{border-collapse:collapse;margin:.5rem 0;font-variant-numeric:tabular-nums}th,td{padding:.22rem .7rem;border-bottom:1px solid #d0d7de;text-align:right}\
th:first-child,td:first-child{text-align:left}.l{text-align:left}.z{color:#68707a}.f{font-weight:600;background:#ddf0ff}.scroll{overflow-x:auto}\
.say{background:#f6f8fa;border-left:.3rem solid #1a7f37;padding:.6rem 1rem;font-size:1.08rem}.say.no{border-color:#cf222e}li{margin:.2rem 0}\
@media(prefers-color-scheme:dark){body{color:#e6edf3;background:#0d1117}figcaption{color:#9da7b3}th,td{border-color:#30363d}.z{color:#848d97}.f{background:#12324f}.say{background:#161b22}}";

/// A page with this title and body.
pub fn document(title: &str, body: &str) -> String {
    format!(
        "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width\">\
         <meta name=\"color-scheme\" content=\"light dark\"><title>{}</title><style>{STYLE}</style>\
         <body><main>{body}</main></body></html>\n",
        escaped(title)
    )
}

/// Escapes text for XML and HTML.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
