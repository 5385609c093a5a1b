/* A soft PLC that reads verdicts on the same machine.
 *
 *   cc -Idaemon/plc/include soft_plc.c -landon_plc -o soft_plc
 *   ./soft_plc STATION [COUNT [ROOT]]
 *
 * Prints every verdict. Ends after COUNT verdicts (0: never) and prints how long they took from the judge to this program. */
#define _POSIX_C_SOURCE 199309L
#include "andon.h"
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

/* One cycle of the PLC: after this long without a verdict it does its other work. A PLC that must not wait asks with 0. */
#define CYCLE_US 10000
/* The longest time for a station to start. */
#define PATIENCE_MS 5000

static uint64_t monotonic_ns(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec;
}

static int by_size(const void *a, const void *b) {
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* Anything that is not known to be right is not right. */
static const char *word(uint8_t outcome) {
    switch (outcome) {
    case ANDON_OUTCOME_OK:
        return "ok";
    case ANDON_OUTCOME_ANOMALY:
        return "nok";
    default:
        return "not-judged";
    }
}

int main(int argc, char **argv) {
    if (argc < 2) {
        fprintf(stderr, "usage: %s STATION [COUNT [ROOT]]\n", argv[0]);
        return 64;
    }
    setvbuf(stdout, NULL, _IOLBF, 0); /* Whoever follows it through a pipe or a file sees each line at once. */
    size_t count = argc > 2 ? strtoul(argv[2], NULL, 10) : 0;
    uint64_t *latency_ns = calloc(count ? count : 1, sizeof *latency_ns);
    AndonReader *reader = NULL;
    if (!latency_ns || andon_open(argc > 3 ? argv[3] : NULL, argv[1], PATIENCE_MS, &reader) < 0) {
        fprintf(stderr, "cannot read verdicts: %s\n", andon_last_error());
        free(latency_ns);
        return 70;
    }
    printf("open\n");

    size_t received = 0;
    uint64_t lost = 0;
    int ready = 0, fault = 0; /* Silence is never ready. */
    while (!fault && (count == 0 || received < count)) {
        AndonVerdict verdict;
        switch (andon_next(reader, CYCLE_US, &verdict)) {
        case ANDON_RESULT_VERDICT:
            if (count)
                latency_ns[received] = monotonic_ns() - verdict.sent_ns;
            received++;
            printf("verdict %llu %s reason %u distance %g station %s part %s\n", (unsigned long long)verdict.seq,
                   word(verdict.outcome), verdict.reason, (double)verdict.distance, verdict.station, verdict.part);
            break;
        case ANDON_RESULT_WRITER_GONE:
            printf("judge gone\n");
            break;
        case ANDON_RESULT_NOTHING:
            break; /* The other work of a cycle. */
        default:
            fprintf(stderr, "%s\n", andon_last_error());
            fault = 1;
        }
        AndonStatus status;
        if (andon_status(reader, &status) < 0)
            continue;
        if (status.ready != ready) {
            ready = status.ready;
            printf("ready %d\n", ready);
        }
        if (status.lost != lost) {
            printf("lost %llu\n", (unsigned long long)(status.lost - lost));
            lost = status.lost;
        }
    }

    AndonStatus status;
    if (andon_status(reader, &status) < 0) {
        fprintf(stderr, "%s\n", andon_last_error());
        andon_close(reader);
        free(latency_ns);
        return 70;
    }
    printf("received %llu lost %llu\n", (unsigned long long)status.received, (unsigned long long)status.lost);
    if (count && received) {
        qsort(latency_ns, received, sizeof *latency_ns, by_size);
        printf("latency_us p50 %.1f p99 %.1f max %.1f\n", (double)latency_ns[received / 2] / 1e3,
               (double)latency_ns[received * 99 / 100] / 1e3, (double)latency_ns[received - 1] / 1e3);
    }
    andon_close(reader);
    free(latency_ns);
    return fault ? 70 : 0;
}
