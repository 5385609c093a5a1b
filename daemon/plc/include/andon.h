/* Andon's verdict channel for a soft PLC on the same machine. Link with -landon_plc.
 * Made from daemon/plc/src/c_abi by `cargo test -p andon-plc --test header` with ANDON_WRITE_HEADER=1; do not edit. */

#ifndef ANDON_H
#define ANDON_H

#include <stddef.h>
#include <stdint.h>

/**
 * What is judged.
 */
enum AndonLevel {
  /**
   * One IU (interaction unit): one contact within a step.
   */
  ANDON_LEVEL_IU = 1,
  /**
   * One activity: a step of the job.
   */
  ANDON_LEVEL_ACTIVITY = 2,
  /**
   * The whole job.
   */
  ANDON_LEVEL_JOB = 3,
};

/**
 * How it came out.
 */
enum AndonOutcome {
  /**
   * It was done right.
   */
  ANDON_OUTCOME_OK = 1,
  /**
   * It can no longer be right.
   */
  ANDON_OUTCOME_ANOMALY = 2,
  /**
   * Too little was seen to decide.
   */
  ANDON_OUTCOME_NOT_JUDGED = 3,
};

/**
 * The rule that decided.
 */
enum AndonReason {
  /**
   * Nothing is wrong.
   */
  ANDON_REASON_NONE = 0,
  /**
   * A wrong object, or the wrong hand: no taught activity that is still possible has this contact.
   */
  ANDON_REASON_WRONG_OBJECT = 1,
  /**
   * Wrong order: the IU belongs to the activity, or the activity to the job, but not at this point.
   */
  ANDON_REASON_WRONG_ORDER = 2,
  /**
   * Wrong motion: its DTW distance exceeds the threshold of every taught activity that is still possible.
   */
  ANDON_REASON_MOTION = 3,
  /**
   * Fewer frames, or fewer reversals of the movement, than the demonstrations allow.
   */
  ANDON_REASON_TOO_SHORT = 4,
  /**
   * More frames, or more reversals of the movement, than the demonstrations allow.
   */
  ANDON_REASON_TOO_LONG = 5,
  /**
   * The activity or the job ended before its last IU or activity.
   */
  ANDON_REASON_NOT_COMPLETED = 6,
  /**
   * It could not be judged, for none of the other reasons.
   */
  ANDON_REASON_UNKNOWN = 7,
  /**
   * Too little of it was seen, for none of the other reasons.
   */
  ANDON_REASON_BLIND = 8,
  /**
   * It lasted longer than can be compared.
   */
  ANDON_REASON_OVERLOAD = 9,
  /**
   * The hand was out of view for too long.
   */
  ANDON_REASON_HAND_NOT_SEEN = 10,
  /**
   * An object was out of view for too long.
   */
  ANDON_REASON_OBJECT_NOT_SEEN = 11,
  /**
   * Its beginning was not seen: it came before the station was enabled, or was hidden.
   */
  ANDON_REASON_BEGINNING_NOT_SEEN = 12,
  /**
   * Aborted before its end: the station was disabled, got another job, or its source began again.
   */
  ANDON_REASON_BROKEN_OFF = 13,
  /**
   * No frame came for too long.
   */
  ANDON_REASON_FRAMES_MISSING = 14,
  /**
   * Too few frames came.
   */
  ANDON_REASON_TOO_FEW_FRAMES = 15,
  /**
   * It could not be told whether its two objects touched or one only passed the other.
   */
  ANDON_REASON_PASSING = 16,
  /**
   * The marker of an object was in view twice, so that it was not known which of the two lay on it.
   */
  ANDON_REASON_MARKER_TWICE = 17,
};

/**
 * What was not shown before.
 */
enum AndonNote {
  /**
   * Nothing.
   */
  ANDON_NOTE_NONE = 0,
  /**
   * The activity came before another one that had come first in all runs that were shown.
   */
  ANDON_NOTE_ORDER = 1,
  /**
   * The activity was done already.
   */
  ANDON_NOTE_AGAIN = 2,
  /**
   * The other hand did it.
   */
  ANDON_NOTE_OTHER_HAND = 3,
  /**
   * An unknown step, with no other parts than those of the job.
   */
  ANDON_NOTE_STEP = 4,
};

/**
 * How the order of the job was broken.
 */
enum AndonOrderFault {
  /**
   * The order was kept.
   */
  ANDON_ORDER_FAULT_NONE = 0,
  /**
   * It began before another one had begun.
   */
  ANDON_ORDER_FAULT_NOT_BEGUN = 1,
  /**
   * It began before another one had ended.
   */
  ANDON_ORDER_FAULT_NOT_ENDED = 2,
  /**
   * It began after another one.
   */
  ANDON_ORDER_FAULT_TOO_LATE = 3,
  /**
   * It was done already: the other one is itself.
   */
  ANDON_ORDER_FAULT_AGAIN = 4,
};

/**
 * Which measure is out of its bounds, and its unit.
 */
enum AndonMeasure {
  /**
   * None.
   */
  ANDON_MEASURE_NONE = 0,
  /**
   * How long it lasted, in seconds.
   */
  ANDON_MEASURE_DURATION = 1,
  /**
   * How many strokes it had, to and fro.
   */
  ANDON_MEASURE_STROKES = 2,
  /**
   * The mean length of a stroke, in metres.
   */
  ANDON_MEASURE_STROKE_LENGTH = 3,
  /**
   * The length of its path, in metres.
   */
  ANDON_MEASURE_PATH = 4,
  /**
   * The angle between its direction and the one that was shown, in degrees.
   */
  ANDON_MEASURE_DIRECTION = 5,
  /**
   * The distance between its place and the one that was shown, in metres.
   */
  ANDON_MEASURE_PLACE = 6,
  /**
   * The lateral deviation: the maximum distance of the hand's path from the straight line, in metres.
   */
  ANDON_MEASURE_LATERAL_DEVIATION = 7,
};

/**
 * Which hand.
 */
enum AndonHand {
  /**
   * No hand: verdicts on jobs.
   */
  ANDON_HAND_NONE = 0,
  /**
   * The right hand.
   */
  ANDON_HAND_RIGHT = 1,
  /**
   * The left hand.
   */
  ANDON_HAND_LEFT = 2,
};

/**
 * In place of an index that has no meaning on this level.
 */
#define ANDON_NO_INDEX 65535

/**
 * Bytes of a station's name, with the zero at its end.
 */
#define ANDON_STATION_BYTES 17

/**
 * Bytes of a part id, with the zero at its end.
 */
#define ANDON_PART_BYTES 33

/**
 * How a call ended. Negative numbers are faults.
 */
enum AndonResult
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  /**
   * No verdict came in time; for the other functions: it is done.
   */
  ANDON_RESULT_NOTHING = 0,
  /**
   * A verdict is in `out`.
   */
  ANDON_RESULT_VERDICT = 1,
  /**
   * The judge has been stopped or has died, and no verdict comes until it is back. Returned once: clear your own ready bit.
   */
  ANDON_RESULT_WRITER_GONE = 2,
  /**
   * A pointer is null, or a text is not UTF-8.
   */
  ANDON_RESULT_ARGUMENT = -1,
  /**
   * The station's name or root is not allowed.
   */
  ANDON_RESULT_STATION = -2,
  /**
   * The station is not running (no steward), or was not ready in time.
   */
  ANDON_RESULT_NO_STEWARD = -3,
  /**
   * The station runs another version of Andon.
   */
  ANDON_RESULT_OTHER_BUILD = -4,
  /**
   * The verdict channel has as many readers as it allows.
   */
  ANDON_RESULT_TOO_MANY_READERS = -5,
  /**
   * Shared memory or the operating system refused.
   */
  ANDON_RESULT_SYSTEM = -6,
  /**
   * A fault in this library. The reader can only be closed.
   */
  ANDON_RESULT_INTERNAL = -7,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum AndonResult AndonResult;
#else
typedef int32_t AndonResult;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * A reader of the verdict channel of one station.
 */
typedef struct AndonReader AndonReader;

/**
 * One verdict.
 */
typedef struct AndonVerdict {
  /**
   * Number of the verdict since this start of the judge, from 1. A gap is a loss.
   */
  uint64_t seq;
  /**
   * Number of this start of the judge.
   */
  uint64_t epoch;
  /**
   * Number of the newest frame that the verdict depends on.
   */
  uint64_t frame_seq;
  /**
   * When that frame was captured, CLOCK_MONOTONIC in nanoseconds.
   */
  uint64_t captured_ns;
  /**
   * When the verdict was sent, CLOCK_MONOTONIC in nanoseconds.
   */
  uint64_t sent_ns;
  /**
   * Hash of the job file.
   */
  uint64_t model_hash;
  /**
   * When the IU, activity or job began, source time in nanoseconds.
   */
  uint64_t began_ns;
  /**
   * When it ended, or when it was decided if that was earlier, source time in nanoseconds.
   */
  uint64_t ended_ns;
  /**
   * Time of the newest feature couple that the decision depends on, source time in nanoseconds.
   */
  uint64_t decided_ns;
  /**
   * When it was decided, nanoseconds since 1970 UTC.
   */
  uint64_t decided_utc_ns;
  /**
   * The job that is watched.
   */
  uint32_t job_id;
  /**
   * DTW distance to the nearest taught motion; NaN if none was computed.
   */
  float distance;
  /**
   * The threshold that the distance was compared with; NaN if there is none.
   */
  float threshold;
  /**
   * The value of the measure that is out of its bounds, in the unit of `measure`; NaN if none is.
   */
  float measured;
  /**
   * The minimum that was shown; NaN if none is out of its bounds.
   */
  float shown_min;
  /**
   * The maximum that was shown; NaN if none is out of its bounds.
   */
  float shown_max;
  /**
   * Context features x_c of the IU; of its first IU for an activity; 0 for a job.
   */
  uint16_t x_c[4];
  /**
   * Index of the activity in this job, from 0, or ANDON_NO_INDEX.
   */
  uint16_t activity;
  /**
   * Index of the IU in its activity, from 0, or ANDON_NO_INDEX.
   */
  uint16_t iu;
  /**
   * Index of the taught activity that it was judged against, or ANDON_NO_INDEX.
   */
  uint16_t nearest;
  /**
   * Index of the other taught activity of the order that was broken, or ANDON_NO_INDEX.
   */
  uint16_t broken_activity;
  /**
   * How many of the runs that were shown keep that order.
   */
  uint16_t broken_runs;
  /**
   * An AndonLevel.
   */
  uint8_t level;
  /**
   * An AndonOutcome. Treat a number that is not in the list as not judged: it comes from another version.
   */
  uint8_t outcome;
  /**
   * An AndonReason.
   */
  uint8_t reason;
  /**
   * An AndonHand.
   */
  uint8_t hand;
  /**
   * 1 if the verdict came before the IU ended, otherwise 0.
   */
  uint8_t early;
  /**
   * An AndonNote: what was not shown before and breaks no rule of the order.
   */
  uint8_t note;
  /**
   * An AndonOrderFault.
   */
  uint8_t broken;
  /**
   * An AndonMeasure: which measure is out of its bounds.
   */
  uint8_t measure;
  /**
   * Name of the station, zero-terminated.
   */
  char station[ANDON_STATION_BYTES];
  /**
   * The part id that was in force when the job began, printable ASCII, zero-terminated; empty if none was given.
   */
  char part[ANDON_PART_BYTES];
} AndonVerdict;

/**
 * What the reader has received since it was opened.
 */
typedef struct AndonStatus {
  /**
   * Number of verdicts received.
   */
  uint64_t received;
  /**
   * Number of verdicts that were sent and not read in time.
   */
  uint64_t lost;
  /**
   * Number of restarts of the judge.
   */
  uint32_t restarts;
  /**
   * 1 if the judge has gone away and no verdict has come since, otherwise 0.
   */
  uint8_t writer_gone;
  /**
   * 1 while every process of the station says that it runs, perceive sees the bench and the judge watches a job, otherwise 0. Silence is 0.
   */
  uint8_t ready;
  /**
   * Keeps the size a multiple of 8.
   */
  uint8_t reserved[2];
} AndonStatus;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/**
 * Opens the verdict channel of `station`. `root` is the station's directory, null for `/run/andon/STATION`. Waits for at most
 * `timeout_ms` for a station that is still starting. Returns ANDON_RESULT_NOTHING and writes the reader to `*out`, or returns a
 * fault and writes null.
 *
 * A reader may be handed from one thread to another, as from the one that starts a program to its cyclic task. It is called by one
 * thread at a time: the caller lets one call return before the next begins. The newest 256 verdicts come first, as they were sent
 * before.
 *
 * # Safety
 * `root` (or null) and `station` are zero-terminated; `out` can be written.
 */
AndonResult andon_open(const char *root,
                       const char *station,
                       uint32_t timeout_ms,
                       struct AndonReader **out);

/**
 * Writes the next verdict to `*out` and returns ANDON_RESULT_VERDICT. When none is there, waits for at most `timeout_us` and returns
 * ANDON_RESULT_NOTHING. A judge that goes away ends the wait with ANDON_RESULT_WRITER_GONE. With `timeout_us` 0, or when a verdict is there, the
 * call does not block. A judge that has gone away is reported all the same.
 *
 * # Safety
 * `reader` is from `andon_open`, not closed, and no other call with it is running; `out` can be written.
 */
AndonResult andon_next(struct AndonReader *reader,
                       uint64_t timeout_us,
                       struct AndonVerdict *out);

/**
 * Writes what the reader has received so far, and whether the station is ready, to `*out` and returns ANDON_RESULT_NOTHING. It does
 * not block: call it in every cycle.
 *
 * # Safety
 * As `andon_next`.
 */
AndonResult andon_status(struct AndonReader *reader,
                         struct AndonStatus *out);

/**
 * Closes a reader. Null is allowed and does nothing.
 *
 * # Safety
 * `reader` is null or from `andon_open`, and is not used any more.
 */
void andon_close(struct AndonReader *reader);

/**
 * What was wrong in the last call of this thread that failed, with the remedy; empty if none has failed. The text is valid until
 * the next call of this thread that fails.
 */
const char *andon_last_error(void);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* ANDON_H */
