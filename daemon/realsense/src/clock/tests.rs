use super::*;
use proptest::prelude::*;

const MS: u64 = 1_000_000;
const SECOND: u64 = 1000 * MS;
/// CLOCK_REALTIME minus CLOCK_MONOTONIC in these tests.
const WALL: u64 = 1_700_000_000 * SECOND;

fn hardware(us: f64) -> SensorTime {
    SensorTime { ms: us / 1000.0, domain: Domain::Hardware }
}

fn arrival(monotonic_ns: u64) -> Arrival {
    Arrival { monotonic_ns, realtime_ns: monotonic_ns + WALL }
}

/// A camera whose counter read `start_us` at the computer's time `T0`.
struct Camera {
    start_us: f64,
    /// How much faster its crystal is than the computer's.
    drift: f64,
}

const T0: u64 = 1000 * SECOND;

impl Camera {
    fn stamp(&self, true_ns: u64) -> SensorTime {
        let us = self.start_us + (true_ns - T0) as f64 / 1000.0 * (1.0 + self.drift);
        hardware(us % (1_u64 << 32) as f64)
    }
}

#[test]
fn jitter_of_the_arrival_does_not_affect_the_capture_time() {
    let camera = Camera { start_us: 5e6, drift: 0.0 };
    let mut clock = CameraClock::default();
    // The third picture is the fastest with 8 ms. From then on every capture time is exact except for these 8 ms.
    for (k, delay_ms) in [15, 12, 8, 30, 9, 8, 250, 11].into_iter().enumerate() {
        let true_ns = T0 + k as u64 * 33 * MS;
        let captured = clock.captured_ns(camera.stamp(true_ns), arrival(true_ns + delay_ms * MS));
        if k >= 2 {
            assert!(captured.abs_diff(true_ns + 8 * MS) < 1000, "picture {k}: {captured}");
        }
    }
}

#[test]
fn a_wrap_of_the_32_bit_counter_goes_unnoticed() {
    let camera = Camera { start_us: (1_u64 << 32) as f64 - 100_000.0, drift: 0.0 };
    let mut clock = CameraClock::default();
    let captured: Vec<u64> = (0..12)
        .map(|k| T0 + k * 33 * MS)
        .map(|true_ns| clock.captured_ns(camera.stamp(true_ns), arrival(true_ns + 8 * MS)))
        .collect();
    for pair in captured.windows(2) {
        assert!((pair[1] - pair[0]).abs_diff(33 * MS) < 1000, "{captured:?}");
    }
}

#[test]
fn a_camera_that_restarts_its_clock_is_followed_at_once() {
    let mut clock = CameraClock::default();
    clock.captured_ns(hardware(900e6), arrival(T0));
    let captured = clock.captured_ns(hardware(2e6), arrival(T0 + SECOND));
    assert_eq!(captured, T0 + SECOND);
    let next = clock.captured_ns(hardware(2.033e6), arrival(T0 + SECOND + 40 * MS));
    assert_eq!(next, T0 + SECOND + 33 * MS);
}

#[test]
fn a_slow_crystal_is_followed_within_two_spans() {
    let camera = Camera { start_us: 0.0, drift: -50e-6 };
    let mut clock = CameraClock::default();
    for k in 0..30 * 600 {
        let true_ns = T0 + k * 33_333_333;
        let captured = clock.captured_ns(camera.stamp(true_ns), arrival(true_ns + 8 * MS));
        // Two spans of 5 s and one picture each, at 50 millionths, although the clocks differ by 30 ms in the end.
        assert!(captured.abs_diff(true_ns + 8 * MS) < 510_000, "after {k} pictures");
    }
}

#[test]
fn a_stamp_of_the_wall_clock_is_shifted_by_the_offset_of_the_clocks() {
    for domain in [Domain::System, Domain::Global] {
        let mut clock = CameraClock::default();
        let stamp = SensorTime { ms: (WALL + T0) as f64 / 1e6, domain };
        let captured = clock.captured_ns(stamp, arrival(T0 + 20 * MS));
        assert!(captured.abs_diff(T0) < 1000, "{captured}");
    }
}

#[test]
fn a_step_of_the_wall_clock_does_not_move_the_capture_time() {
    let mut clock = CameraClock::default();
    for k in 0..10 {
        let true_ns = T0 + k * 33 * MS;
        // The wall clock is set forward by an hour between the pictures 4 and 5.
        let wall = if k < 5 { WALL } else { WALL + 3600 * SECOND };
        let stamp = SensorTime { ms: (wall + true_ns) as f64 / 1e6, domain: Domain::System };
        let arrival = Arrival { monotonic_ns: true_ns + 9 * MS, realtime_ns: true_ns + 9 * MS + wall };
        assert!(clock.captured_ns(stamp, arrival).abs_diff(true_ns) < 1000, "picture {k}");
    }
}

#[test]
fn a_picture_stamped_before_a_step_counts_as_captured_on_arrival() {
    let mut clock = CameraClock::default();
    let stamp = SensorTime { ms: (WALL + T0) as f64 / 1e6, domain: Domain::Global };
    let stepped = Arrival { monotonic_ns: T0 + 9 * MS, realtime_ns: T0 + 9 * MS + WALL + 3600 * SECOND };
    assert_eq!(clock.captured_ns(stamp, stepped), T0 + 9 * MS);
}

#[test]
fn a_change_of_the_clock_in_mid_stream_restarts_the_estimate() {
    let mut clock = CameraClock::default();
    clock.captured_ns(hardware(5e6), arrival(T0));
    let stamp = SensorTime { ms: (WALL + T0 + 33 * MS) as f64 / 1e6, domain: Domain::Global };
    assert!(clock.captured_ns(stamp, arrival(T0 + 40 * MS)).abs_diff(T0 + 33 * MS) < 1000);
    assert_eq!(clock.captured_ns(hardware(5.066e6), arrival(T0 + 70 * MS)), T0 + 70 * MS);
}

#[test]
fn a_recording_starts_at_zero_and_continues_where_its_camera_restarts_its_clock() {
    let mut clock = RecordingClock::default();
    let times: Vec<u64> = [7000.0, 7033.0, 7066.0, 7000.0, 7033.0]
        .map(|ms| clock.since_first_ns(hardware(ms * 1000.0)))
        .to_vec();
    assert_eq!(times, [0, 33 * MS, 66 * MS, 99 * MS, 132 * MS]);
}

#[test]
fn a_recording_may_contain_a_wrap_of_its_camera() {
    let end = (1_u64 << 32) as f64;
    let mut clock = RecordingClock::default();
    let times = [end - 20_000.0, 13_000.0].map(|us| clock.since_first_ns(hardware(us)));
    assert_eq!(times, [0, 33 * MS]);
}

proptest! {
    #[test]
    fn a_capture_is_never_later_than_its_arrival_and_time_never_stands_still(
        steps in prop::collection::vec((0_u32..5_000_000, 0_u64..400, 0_u8..3), 1..200),
    ) {
        let mut clock = CameraClock::default();
        let (mut now, mut before) = (T0, 0);
        for (stamp_ms, gap_ms, domain) in steps {
            now += gap_ms * MS + 200;
            let domain = [Domain::Hardware, Domain::System, Domain::Global][usize::from(domain)];
            let captured = clock.captured_ns(SensorTime { ms: f64::from(stamp_ms), domain }, arrival(now));
            prop_assert!(captured <= now && captured > before);
            before = captured;
        }
    }
}
