//! Who has changed what, newest first.

use super::technician::heads;
use crate::audited::Audited;
use crate::board::Board;
use crate::html::Html;
use crate::words::Table;

/// What was done is in the language of the journal.
pub(super) fn draw(html: &mut Html, board: &Board, words: &Table) {
    html.element("<section id=\"audit\"><h2>", words.say("engineer.audit"), "</h2>");
    if board.desk.audited.is_empty() {
        html.element("<p>", words.say("label.none"), "</p></section>");
        return;
    }
    html.raw("<div class=\"wide\"><table><thead><tr>");
    heads(html, words, &["time", "who", "kind", "what", "outcome"]);
    html.raw("</tr></thead><tbody>");
    for Audited { utc_ns, kind, who, what, became } in &board.desk.audited {
        html.element("<tr><td>", &(board.settings.local_time)(*utc_ns), "</td>");
        html.element("<td>", who, "</td>");
        html.element("<td>", words.say(&format!("audit.{kind}")), "</td>");
        html.element("<td lang=\"en\">", what, "</td>").element("<td lang=\"en\">", became, "</td></tr>");
    }
    html.raw("</tbody></table></div></section>");
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::sample::settings;
    use shm_schemas::AuditKind;

    #[test]
    fn each_kind_of_deed_is_told_with_who_did_it_and_what_became_of_it_in_the_words_of_the_page() {
        let mut board = Board::new(settings());
        let deed = |(number, kind): (usize, &AuditKind)| Audited {
            utc_ns: number as u64,
            kind: kind.name().to_owned(),
            who: "login eva".to_owned(),
            what: "load polish".to_owned(),
            became: "done".to_owned(),
        };
        let newest_first: Vec<Audited> = AuditKind::ALL.iter().enumerate().map(deed).rev().collect();
        let before = board.version;
        board.audited(newest_first.clone());
        board.audited(newest_first);
        assert_eq!(board.version, before + 1, "what is as it was is not sent again");
        for (code, _) in board.settings.tables.languages() {
            let words = board.settings.tables.get(code).unwrap();
            let mut html = Html::default();
            draw(&mut html, &board, words);
            let drawn = html.finish();
            let rows: Vec<&str> = drawn.split("<tr>").skip(2).collect();
            assert_eq!(rows.len(), AuditKind::ALL.len(), "{code}");
            for ((number, kind), row) in AuditKind::ALL.iter().enumerate().rev().zip(rows) {
                let key = format!("audit.{}", kind.name());
                assert!(words.has(&key), "{code}: {key}");
                let cells = format!(
                    "<td>{number}</td><td>login eva</td><td>{}</td>",
                    words.say(&key).replace('\'', "&#39;")
                );
                let rest = "<td lang=\"en\">load polish</td><td lang=\"en\">done</td>";
                assert!(row.starts_with(&(cells + rest)), "{code}: {row}");
            }
        }
    }
}
