/* Andon's verdict channel for a soft PLC on the same machine. Link with -landon_plc.
 * Made from daemon/plc/src/c_abi by `cargo test -p andon-plc --test header` with ANDON_WRITE_HEADER=1; do not edit. */

#ifndef ANDON_H
#define ANDON_H

#include <stddef.h>
#include <stdint.h>

/**
 * In place of an index that has no meaning for this kind of verdict.
 */
#define ANDON_NO_INDEX 65535

/**
 * Bytes of a station's name with the zero behind it.
 */
#define ANDON_STATION_BYTES 17

/**
 * How a call ended: not negative is no fault.
 */
enum AndonResult
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  /**
   * Nothing came in time; or: done.
   */
  ANDON_RESULT_NOTHING = 0,
  /**
   * A verdict is in `out`.
   */
  ANDON_RESULT_VERDICT = 1,
  /**
   * The judge is gone, stopped or dead: nothing comes until it is back. Said once. Drop ready.
   */
  ANDON_RESULT_WRITER_GONE = 2,
  /**
   * A null pointer, or text that is not UTF-8.
   */
  ANDON_RESULT_ARGUMENT = -1,
  /**
   * The station's name or root cannot be used.
   */
  ANDON_RESULT_STATION = -2,
  /**
   * The station has no steward.
   */
  ANDON_RESULT_NO_STEWARD = -3,
  /**
   * The station runs another build.
   */
  ANDON_RESULT_OTHER_BUILD = -4,
  /**
   * Too many readers.
   */
  ANDON_RESULT_TOO_MANY_READERS = -5,
  /**
   * Shared memory or the system refused.
   */
  ANDON_RESULT_SYSTEM = -6,
  /**
   * A fault in this library; the reader cannot be used any more, only closed.
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
 * What is judged, and how it came out.
 */
enum AndonKind
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint8_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  /**
   * The IU is right.
   */
  ANDON_KIND_IU_OK = 1,
  /**
   * The IU cannot be right any more.
   */
  ANDON_KIND_IU_ANOMALY = 2,
  /**
   * The activity is right.
   */
  ANDON_KIND_ACTIVITY_OK = 3,
  /**
   * The activity cannot be right any more.
   */
  ANDON_KIND_ACTIVITY_ANOMALY = 4,
  /**
   * The job is right.
   */
  ANDON_KIND_JOB_OK = 5,
  /**
   * The job cannot be right any more.
   */
  ANDON_KIND_JOB_ANOMALY = 6,
  /**
   * There was too little to go by.
   */
  ANDON_KIND_NOT_JUDGED = 7,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum AndonKind AndonKind;
#else
typedef uint8_t AndonKind;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * The rule that decided.
 */
enum AndonReason
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint8_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  /**
   * Nothing is wrong.
   */
  ANDON_REASON_NONE = 0,
  /**
   * The context belongs to no nominal activity.
   */
  ANDON_REASON_WRONG_OBJECT = 1,
  /**
   * The context or the activity does not belong here.
   */
  ANDON_REASON_WRONG_ORDER = 2,
  /**
   * The DTW distance is over the threshold of every candidate.
   */
  ANDON_REASON_MOTION = 3,
  /**
   * Less than in any correct demonstration's bounds.
   */
  ANDON_REASON_TOO_SHORT = 4,
  /**
   * More than in any correct demonstration's bounds.
   */
  ANDON_REASON_TOO_LONG = 5,
  /**
   * The activity or the job ended before its last part.
   */
  ANDON_REASON_NOT_COMPLETED = 6,
  /**
   * It could not be told.
   */
  ANDON_REASON_UNKNOWN = 7,
  /**
   * The hand or an object was out of sight for too long.
   */
  ANDON_REASON_BLIND = 8,
  /**
   * A capacity was full.
   */
  ANDON_REASON_OVERLOAD = 9,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum AndonReason AndonReason;
#else
typedef uint8_t AndonReason;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * Which hand.
 */
enum AndonHand
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint8_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
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
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum AndonHand AndonHand;
#else
typedef uint8_t AndonHand;
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
   * Number among its judge's, from 1. A jump is a loss.
   */
  uint64_t seq;
  /**
   * One per start of the judge.
   */
  uint64_t epoch;
  /**
   * The newest frame it rests on.
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
   * When what is judged began, source time in nanoseconds.
   */
  uint64_t began_ns;
  /**
   * When it ended, source time in nanoseconds.
   */
  uint64_t ended_ns;
  /**
   * The newest couple the decision rests on, source time in nanoseconds.
   */
  uint64_t decided_ns;
  /**
   * When it was decided, nanoseconds since 1970 UTC.
   */
  uint64_t decided_utc_ns;
  /**
   * The job.
   */
  uint32_t job_id;
  /**
   * DTW distance to the nearest nominal; NaN none.
   */
  float distance;
  /**
   * The threshold it was held against; NaN none.
   */
  float threshold;
  /**
   * Context features x_c.
   */
  uint16_t x_c[4];
  /**
   * Number of the activity in this job, from 0, or ANDON_NO_INDEX.
   */
  uint16_t activity;
  /**
   * Number of the IU in its activity, from 0, or ANDON_NO_INDEX.
   */
  uint16_t iu;
  /**
   * The nominal activity it is judged against, or ANDON_NO_INDEX.
   */
  uint16_t nearest;
  /**
   * An AndonKind. A number that is not in the list comes from another build: treat it as not judged.
   */
  uint8_t kind;
  /**
   * An AndonReason.
   */
  uint8_t reason;
  /**
   * An AndonHand.
   */
  uint8_t hand;
  /**
   * 1: said before the IU ended.
   */
  uint8_t early;
  /**
   * Name of the station, zero-terminated.
   */
  char station[ANDON_STATION_BYTES];
} AndonVerdict;

/**
 * What the reader has seen since it was opened.
 */
typedef struct AndonStatus {
  /**
   * Verdicts received.
   */
  uint64_t received;
  /**
   * Verdicts sent and not received in time.
   */
  uint64_t lost;
  /**
   * Starts of the judge after the first.
   */
  uint32_t restarts;
  /**
   * 1: the judge went away and nothing has come since.
   */
  uint8_t writer_gone;
  /**
   * Keeps the size a multiple of 8.
   */
  uint8_t reserved[3];
} AndonStatus;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/**
 * Opens the verdict channel of `station`. `root` is the station's directory, null for `/run/andon/STATION`. Waits for at most
 * `patience_ms` for a station that is still starting. Gives ANDON_RESULT_NOTHING and `*out`, or a fault and null.
 *
 * A reader belongs to one thread at a time. The newest 256 verdicts come first, as they were sent before.
 *
 * # Safety
 * `root` (or null) and `station` are zero-terminated; `out` can be written.
 */
AndonResult andon_open(const char *root,
                       const char *station,
                       uint32_t patience_ms,
                       struct AndonReader **out);

/**
 * The next verdict into `*out`: ANDON_RESULT_VERDICT. A look at what is there takes no lock and waits for nobody; only where nothing
 * is there, and `timeout_us` is not 0, it blocks, at most for so long: ANDON_RESULT_NOTHING. A judge that goes away ends the wait:
 * ANDON_RESULT_WRITER_GONE.
 *
 * # Safety
 * `reader` is from `andon_open`, not closed, and not in use in another thread; `out` can be written.
 */
AndonResult andon_next(struct AndonReader *reader,
                       uint64_t timeout_us,
                       struct AndonVerdict *out);

/**
 * What the reader has seen, into `*out`: ANDON_RESULT_NOTHING.
 *
 * # Safety
 * As `andon_next`.
 */
AndonResult andon_status(const struct AndonReader *reader, struct AndonStatus *out);

/**
 * Closes a reader; null does nothing.
 *
 * # Safety
 * `reader` is null or from `andon_open`, and is not used any more.
 */
void andon_close(struct AndonReader *reader);

/**
 * What was wrong in the last call of this thread that failed, with the remedy; empty at first. Valid until the next call that
 * fails in this thread.
 */
const char *andon_last_error(void);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* ANDON_H */
