//! Verdicts: the method to shared memory and back.

use andon_core::couple::Context;
use andon_core::input::Side;
use andon_core::verdict::{Kind, Reason, Verdict};
use shm_schemas::{HandCode, NO_INDEX, STATION_BYTES, Verdict as Message, VerdictKind, VerdictReason};

/// What is the same for every verdict of a judge.
#[derive(Clone, Copy, Debug)]
pub struct Sender {
    /// The job that is watched.
    pub job_id: u32,
    /// Hash of its file.
    pub model_hash: u64,
    /// Name of the station, filled up with zeros.
    pub station: [u8; STATION_BYTES],
}

/// The name of a station as a message carries it; what does not fit is cut off.
pub fn station_name(name: &str) -> [u8; STATION_BYTES] {
    let mut bytes = [0; STATION_BYTES];
    for (place, byte) in bytes.iter_mut().zip(name.bytes()) {
        *place = byte;
    }
    bytes
}

/// Writes a verdict into the loaned message.
pub fn write(verdict: &Verdict, sender: &Sender, utc_ns: u64, message: &mut Message) {
    let none = |index: Option<u16>| index.unwrap_or(NO_INDEX);
    message.job_id = sender.job_id;
    message.model_hash = sender.model_hash;
    message.station = sender.station;
    message.began_ns = verdict.began_ns;
    message.ended_ns = verdict.ended_ns;
    message.decided_ns = verdict.decided_ns;
    message.decided_utc_ns = utc_ns;
    message.distance = verdict.distance.unwrap_or(f32::NAN);
    message.threshold = verdict.threshold.unwrap_or(f32::NAN);
    message.x_c = verdict.context.0;
    message.activity = if verdict.side.is_some() { verdict.activity } else { NO_INDEX };
    message.iu = none(verdict.iu);
    message.nearest = none(verdict.nearest);
    message.kind = kind(verdict.kind).code();
    message.reason = reason(verdict.reason).code();
    message.hand = verdict.side.map_or(HandCode::None, hand).code();
    message.early = u8::from(verdict.early);
}

fn kind(kind: Kind) -> VerdictKind {
    match kind {
        Kind::IuOk => VerdictKind::IuOk,
        Kind::IuAnomaly => VerdictKind::IuAnomaly,
        Kind::ActivityOk => VerdictKind::ActivityOk,
        Kind::ActivityAnomaly => VerdictKind::ActivityAnomaly,
        Kind::JobOk => VerdictKind::JobOk,
        Kind::JobAnomaly => VerdictKind::JobAnomaly,
        Kind::NotJudged => VerdictKind::NotJudged,
    }
}

fn reason(reason: Reason) -> VerdictReason {
    match reason {
        Reason::None => VerdictReason::None,
        Reason::WrongObject => VerdictReason::WrongObject,
        Reason::WrongOrder => VerdictReason::WrongOrder,
        Reason::Motion => VerdictReason::Motion,
        Reason::TooShort => VerdictReason::TooShort,
        Reason::TooLong => VerdictReason::TooLong,
        Reason::NotCompleted => VerdictReason::NotCompleted,
        Reason::Unknown => VerdictReason::Unknown,
        Reason::Blind => VerdictReason::Blind,
        Reason::Overload => VerdictReason::Overload,
    }
}

fn hand(side: Side) -> HandCode {
    match side {
        Side::Right => HandCode::Right,
        Side::Left => HandCode::Left,
    }
}

/// A verdict out of shared memory; `None` where a code is unknown, which a required layout hash rules out between
/// builds of one version.
pub fn read(message: &Message) -> Option<Verdict> {
    let kind = match VerdictKind::try_from(message.kind).ok()? {
        VerdictKind::IuOk => Kind::IuOk,
        VerdictKind::IuAnomaly => Kind::IuAnomaly,
        VerdictKind::ActivityOk => Kind::ActivityOk,
        VerdictKind::ActivityAnomaly => Kind::ActivityAnomaly,
        VerdictKind::JobOk => Kind::JobOk,
        VerdictKind::JobAnomaly => Kind::JobAnomaly,
        VerdictKind::NotJudged => Kind::NotJudged,
    };
    let reason = match VerdictReason::try_from(message.reason).ok()? {
        VerdictReason::None => Reason::None,
        VerdictReason::WrongObject => Reason::WrongObject,
        VerdictReason::WrongOrder => Reason::WrongOrder,
        VerdictReason::Motion => Reason::Motion,
        VerdictReason::TooShort => Reason::TooShort,
        VerdictReason::TooLong => Reason::TooLong,
        VerdictReason::NotCompleted => Reason::NotCompleted,
        VerdictReason::Unknown => Reason::Unknown,
        VerdictReason::Blind => Reason::Blind,
        VerdictReason::Overload => Reason::Overload,
    };
    let side = match HandCode::try_from(message.hand).ok()? {
        HandCode::None => None,
        HandCode::Right => Some(Side::Right),
        HandCode::Left => Some(Side::Left),
    };
    let index = |value: u16| (value != NO_INDEX).then_some(value);
    let number = |value: f32| (!value.is_nan()).then_some(value);
    Some(Verdict {
        kind,
        reason,
        side,
        nearest: index(message.nearest),
        activity: index(message.activity).unwrap_or(0),
        iu: index(message.iu),
        context: Context(message.x_c),
        distance: number(message.distance),
        threshold: number(message.threshold),
        early: message.early != 0,
        began_ns: message.began_ns,
        ended_ns: message.ended_ns,
        decided_ns: message.decided_ns,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const KINDS: [Kind; 7] = [
        Kind::IuOk,
        Kind::IuAnomaly,
        Kind::ActivityOk,
        Kind::ActivityAnomaly,
        Kind::JobOk,
        Kind::JobAnomaly,
        Kind::NotJudged,
    ];
    const REASONS: [Reason; 10] = [
        Reason::None,
        Reason::WrongObject,
        Reason::WrongOrder,
        Reason::Motion,
        Reason::TooShort,
        Reason::TooLong,
        Reason::NotCompleted,
        Reason::Unknown,
        Reason::Blind,
        Reason::Overload,
    ];

    #[test]
    fn every_verdict_comes_out_of_shared_memory_as_it_went_in() {
        let sender = Sender { job_id: 1, model_hash: 2, station: station_name("bench1") };
        for kind in KINDS {
            for reason in REASONS {
                for side in [Some(Side::Right), Some(Side::Left), None] {
                    let verdict = Verdict {
                        kind,
                        reason,
                        side,
                        nearest: side.map(|_| 3),
                        activity: if side.is_some() { 4 } else { 0 },
                        iu: side.map(|_| 5),
                        context: Context([1, 5, 5, 6]),
                        distance: side.map(|_| 1.5),
                        threshold: None,
                        early: true,
                        began_ns: 6,
                        ended_ns: 7,
                        decided_ns: 8,
                    };
                    let mut message = Message::default();
                    write(&verdict, &sender, 9, &mut message);
                    assert_eq!(read(&message), Some(verdict));
                }
            }
        }
    }

    #[test]
    fn an_empty_message_is_no_verdict() {
        assert_eq!(read(&Message::default()), None);
    }
}
