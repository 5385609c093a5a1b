//! Verdicts, from the method to shared memory and back.
//!
//! Each field is named once in each direction. The method says by an `Option` whether there is a value, and keeps together what belongs together,
//! such as a measure with what was shown. The wire is flat and has numbers for none, and the method must not know it. A list that makes both
//! directions would need a conversion for each pair of types, and would have the three groups by hand all the same.
//!
//! Two tests hold it to the table of `verdict_fields!`. What [`read`] leaves out is missing in JSON (`verdict_columns`), and what [`write`] leaves out
//! does not come back (below).

use andon_core::couple::Context;
use andon_core::input::Side;
use andon_core::verdict::{
    BrokenOrder, Level, Measure, Measured, Missing, Note, OrderFault, Outcome, Reason, Verdict,
};
use andon_ipc::UtcTime;
use shm_schemas::{
    HandCode, MeasuredWords, NO_INDEX, NO_PERCENT, OrderFault as WireFault, PartId, STATION_BYTES,
    Verdict as Message, VerdictLevel, VerdictMeasure, VerdictNote, VerdictOutcome, VerdictReason,
};

/// What all verdicts on one job have in common.
#[derive(Clone, Copy, Debug)]
pub struct Sender {
    /// The job that is watched.
    pub job_id: u32,
    /// Hash of its file.
    pub model_hash: u64,
    /// Name of the station, padded with zeros.
    pub station: [u8; STATION_BYTES],
    /// The part that the job is done to.
    pub part: PartId,
}

/// The name of a station as a message carries it, cut off where it does not fit.
pub fn station_name(name: &str) -> [u8; STATION_BYTES] {
    let mut bytes = [0; STATION_BYTES];
    for (to, from) in bytes.iter_mut().zip(name.bytes()) {
        *to = from;
    }
    bytes
}

/// Writes a verdict into the loaned message.
pub fn write(verdict: &Verdict, sender: &Sender, decided: UtcTime, message: &mut Message) {
    let none = |index: Option<u16>| index.unwrap_or(NO_INDEX);
    message.job_id = sender.job_id;
    message.model_hash = sender.model_hash;
    message.station = sender.station;
    message.part = sender.part;
    message.began_ns = verdict.began_ns;
    message.ended_ns = verdict.ended_ns;
    message.decided_ns = verdict.decided_ns;
    message.decided_utc_ns = decided.nanoseconds();
    message.distance = verdict.distance.unwrap_or(f32::NAN);
    message.threshold = verdict.threshold.unwrap_or(f32::NAN);
    let measured = verdict.measured;
    message.measure = measured.map_or(VerdictMeasure::None, |measured| measure(measured.measure)).code();
    message.measured = measured.map_or(f32::NAN, |measured| measured.value);
    message.shown_min = measured.map_or(f32::NAN, |measured| measured.shown_min);
    message.shown_max = measured.map_or(f32::NAN, |measured| measured.shown_max);
    message.x_c = verdict.context.0;
    message.activity = if verdict.level == Level::Job { NO_INDEX } else { verdict.activity };
    message.iu = none(verdict.iu);
    message.nearest = none(verdict.nearest);
    message.level = level(verdict.level).code();
    message.outcome = outcome(verdict.outcome).code();
    message.reason = reason(verdict.reason).code();
    message.hand = verdict.side.map_or(HandCode::None, hand).code();
    message.early = u8::from(verdict.early);
    message.captured_percent = verdict.captured_percent.unwrap_or(NO_PERCENT);
    message.seen_percent = verdict.seen_percent.unwrap_or(NO_PERCENT);
    write_missing(&verdict.missing, message);
    message.note = verdict.note.map_or(VerdictNote::None, note).code();
    message.broken = verdict.broken.map_or(WireFault::None, |broken| order_fault(broken.fault)).code();
    message.broken_activity = none(verdict.broken.map(|broken| broken.activity));
    message.broken_runs = verdict.broken.map_or(0, |broken| broken.runs);
}

fn write_missing(missing: &Missing, message: &mut Message) {
    message.missing_hand = missing.hand.map_or(HandCode::None, hand).code();
    message.missing_object = missing.object.unwrap_or(0);
    message.missing_s = missing.seconds.unwrap_or(f32::NAN);
    message.missing_percent = missing.captured_percent.unwrap_or(NO_PERCENT);
    message.needed_percent = missing.needed_percent.unwrap_or(NO_PERCENT);
}

/// Converts an enum of the method to the same enum on the wire and back, by one list of the variants that both have.
macro_rules! twins {
    ($method:ident as $wire:ident, $to_wire:ident, $to_method:ident: $($variant:ident)+) => {
        /// The value as it travels.
        pub(crate) const fn $to_wire(value: $method) -> $wire {
            match value { $( $method::$variant => $wire::$variant, )+ }
        }

        const fn $to_method(value: $wire) -> $method {
            match value { $( $wire::$variant => $method::$variant, )+ }
        }
    };
}

twins!(Level as VerdictLevel, level, level_of_method: Iu Activity Job);
twins!(Outcome as VerdictOutcome, outcome, outcome_of_method: Ok Anomaly NotJudged);
twins!(
    Reason as VerdictReason, reason, reason_of_method:
    None WrongObject WrongOrder Motion TooShort TooLong NotCompleted Unknown Blind Overload HandNotSeen ObjectNotSeen
    BeginningNotSeen BrokenOff FramesMissing TooFewFrames Passing MarkerTwice
);

/// As [`twins`], where the wire has a word for none.
macro_rules! twins_or_none {
    ($method:ident as $wire:ident, $to_wire:ident, $to_method:ident: $($variant:ident)+) => {
        /// The value as it travels.
        pub(crate) const fn $to_wire(value: $method) -> $wire {
            match value { $( $method::$variant => $wire::$variant, )+ }
        }

        /// The value of the method; `None` for the word for none.
        pub(super) const fn $to_method(value: $wire) -> Option<$method> {
            match value {
                $wire::None => None,
                $( $wire::$variant => Some($method::$variant), )+
            }
        }
    };
}

twins_or_none!(Note as VerdictNote, note, note_of_method: Order Again OtherHand Step);
twins_or_none!(
    Measure as VerdictMeasure, measure, measure_of_method:
    Duration Strokes StrokeLength Path LateralDeviation Direction Place
);
twins_or_none!(OrderFault as WireFault, order_fault, order_fault_of_method: NotBegun NotEnded TooLate Again);
twins_or_none!(Side as HandCode, hand, side: Right Left);

/// A measure that is out of its bounds, as a person says it.
pub(crate) const fn measured_words(measured: Measured) -> MeasuredWords {
    let Measured { measure: of, value, shown_min, shown_max } = measured;
    MeasuredWords { measure: measure(of), value, shown_min, shown_max }
}

/// Reads a verdict from a message; `None` where a code is unknown, which does not happen between builds with the same layout hash.
pub fn read(message: &Message) -> Option<Verdict> {
    let index = |value: u16| (value != NO_INDEX).then_some(value);
    let number = |value: f32| (!value.is_nan()).then_some(value);
    let percent = |value: u8| (value != NO_PERCENT).then_some(value);
    let fault = order_fault_of_method(message.broken.try_into().ok()?);
    let (activity, runs) = (message.broken_activity, message.broken_runs);
    let measure = measure_of_method(message.measure.try_into().ok()?);
    let measured = |measure: Measure| Measured {
        measure,
        value: message.measured,
        shown_min: message.shown_min,
        shown_max: message.shown_max,
    };
    Some(Verdict {
        level: level_of_method(message.level().ok()?),
        outcome: outcome_of_method(message.outcome().ok()?),
        reason: reason_of_method(message.reason.try_into().ok()?),
        side: side(message.hand.try_into().ok()?),
        nearest: index(message.nearest),
        activity: index(message.activity).unwrap_or(0),
        iu: index(message.iu),
        context: Context(message.x_c),
        distance: number(message.distance),
        threshold: number(message.threshold),
        captured_percent: percent(message.captured_percent),
        seen_percent: percent(message.seen_percent),
        missing: Missing {
            hand: side(message.missing_hand.try_into().ok()?),
            object: Some(message.missing_object).filter(|id| *id != 0),
            seconds: number(message.missing_s),
            captured_percent: percent(message.missing_percent),
            needed_percent: percent(message.needed_percent),
        },
        measured: measure.map(measured),
        broken: fault.map(|fault| BrokenOrder { fault, activity, runs }),
        note: note_of_method(message.note.try_into().ok()?),
        early: message.early != 0,
        began_ns: message.began_ns,
        ended_ns: message.ended_ns,
        decided_ns: message.decided_ns,
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn every_verdict_comes_out_of_shared_memory_as_it_went_in() {
        let part = PartId::new(b"A-17").unwrap();
        let sender = Sender { job_id: 1, model_hash: 2, station: station_name("bench1"), part };
        let notes = VerdictNote::ALL.iter().copied().map(note_of_method);
        let faults = WireFault::ALL.iter().copied().map(order_fault_of_method);
        let measures = VerdictMeasure::ALL.iter().copied().map(measure_of_method);
        let decided = UtcTime::now();
        let mut orders = notes.cycle().zip(faults.cycle()).zip(measures.cycle());
        for outcome in VerdictOutcome::ALL.iter().copied().map(outcome_of_method) {
            for reason in VerdictReason::ALL.iter().copied().map(reason_of_method) {
                for (level, side) in
                    [(Level::Iu, Some(Side::Right)), (Level::Activity, Some(Side::Left)), (Level::Job, None)]
                {
                    let ((note, fault), measure) = orders.next().unwrap();
                    let measured = |measure| Measured { measure, value: 4.0, shown_min: 6.0, shown_max: 6.5 };
                    let verdict = Verdict {
                        level,
                        outcome,
                        reason,
                        side,
                        nearest: side.map(|_| 3),
                        activity: if side.is_some() { 4 } else { 0 },
                        iu: side.map(|_| 5),
                        context: Context([1, 5, 5, 6]),
                        distance: side.map(|_| 1.5),
                        threshold: None,
                        captured_percent: side.map(|_| 40),
                        seen_percent: side.map(|_| 30),
                        missing: Missing {
                            hand: side,
                            object: side.map(|_| 11),
                            seconds: side.map(|_| 1.25),
                            captured_percent: side.map(|_| 20),
                            needed_percent: side.map(|_| 25),
                        },
                        measured: measure.map(measured),
                        broken: fault.map(|fault| BrokenOrder { fault, activity: 9, runs: 10 }),
                        note,
                        early: true,
                        began_ns: 6,
                        ended_ns: 7,
                        decided_ns: 8,
                    };
                    let mut message = Message::default();
                    write(&verdict, &sender, decided, &mut message);
                    assert_eq!(read(&message), Some(verdict));
                    // What the method does not know.
                    let Message { job_id, model_hash, station, decided_utc_ns, .. } = message;
                    assert_eq!((job_id, model_hash, decided_utc_ns), (1, 2, decided.nanoseconds()));
                    assert_eq!((station, message.part), (sender.station, part));
                }
            }
        }
    }

    #[test]
    fn a_hand_has_the_same_name_in_the_method_and_on_the_wire() {
        for side in Side::ALL {
            assert_eq!(hand(side).name(), side.name());
        }
    }

    #[test]
    fn an_empty_message_is_no_verdict() {
        assert_eq!(read(&Message::default()), None);
    }
}
