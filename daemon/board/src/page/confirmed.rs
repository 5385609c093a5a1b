//! What people say of a verdict, and the buttons to say it.
//!
//! The rows are drawn alike for all who may say something. The form that the buttons belong to stands apart: it has the token of its session.

use shm_schemas::Verdict;

use super::technician::name_of;
use super::{plain, token};
use crate::access::Visitor;
use crate::address::Address;
use crate::board::Board;
use crate::confirm::Was;
use crate::html::Html;
use crate::words::Table;

/// The form of all buttons.
pub(super) fn form(html: &mut Html, address: &Address, visitor: &Visitor) {
    if let Some(session) = visitor.session.as_ref().filter(|_| address.may_confirm) {
        html.raw("<form id=\"confirm\" method=\"post\" action=\"/confirm\">");
        token(html, session);
        plain::place(html, address);
        html.raw("</form>");
    }
}

/// What was said of a verdict, and the buttons.
pub(super) fn draw(html: &mut Html, board: &Board, words: &Table, address: &Address, verdict: &Verdict) {
    let said = board.confirmations.of(verdict.stamp.id());
    match said {
        Some((was, who)) => {
            html.raw(if was == Was::Right { "\u{2713} " } else { "\u{2715} " });
            html.text(words.say(&format!("confirm.was_{}", was.name())));
            html.element(" <small>", who, "</small>");
        }
        None if !address.may_confirm => {
            html.raw("\u{2013}");
        }
        None => (),
    }
    if address.may_confirm {
        let name = name_of(verdict);
        html.raw("<span class=\"say\">");
        for was in Was::ALL.into_iter().filter(|was| said.is_none_or(|(before, _)| before != *was)) {
            html.raw("<button form=\"confirm\" name=\"").text(was.name()).raw("\" value=\"").text(&name);
            html.element("\">", words.say(&format!("confirm.{}", was.name())), "</button>");
        }
        html.raw("</span>");
    }
}
