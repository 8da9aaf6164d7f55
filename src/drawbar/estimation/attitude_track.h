/* Attitude track of one body: roll and pitch over the last samples, and the weight of the corrections by them.
 *
 * A fix is corrected by the attitude at its own time. Where the newest is older than OLDEST_ATTITUDE the correction fades out
 * within FADE, and fades in again: a correction of decimetres that jumps would look like a false fix.
 */
#ifndef DRAWBAR_ATTITUDE_TRACK_H
#define DRAWBAR_ATTITUDE_TRACK_H

#include <stdint.h>
#include <string.h>
#include "geometry.h"

#define ATTITUDES 8                        /* samples that are kept */
#define OLDEST_ATTITUDE 0.5                /* age up to which the newest attitude counts as the present one, s */
#define FADE 2.0                           /* time in which a correction fades out or in, s */
#define MOST_LEAN 0.45                     /* largest plausible roll and pitch, rad */

struct attitude_track {
    time_stamp time[ATTITUDES];            /* oldest first */
    double roll[ATTITUDES], pitch[ATTITUDES];   /* rad */
    double weight;                         /* of the correction, 0 .. 1 */
    int32_t count, initialised;
};

/* Record an attitude (rad) that is now (s) of an age (s). One that is not finite, implausible, not newer than the last or of
 * the future is dropped; a missing pitch counts as level. Returns whether it was recorded. */
static inline int attitude_record(struct attitude_track *track, time_stamp now, double age, double roll, double pitch)
{
    const time_stamp time = now - age;
    const double level = isfinite(pitch) ? pitch : 0.0;
    const int32_t last = track->count - 1;

    if (!isfinite(time) || age < 0.0 || !(fabs(roll) <= MOST_LEAN) || !(fabs(level) <= MOST_LEAN)
        || (last >= 0 && !(time > track->time[last])))
        return 0;
    if (track->count == ATTITUDES) {
        memmove(track->time, track->time + 1, (ATTITUDES - 1) * sizeof(time_stamp));
        memmove(track->roll, track->roll + 1, (ATTITUDES - 1) * sizeof(double));
        memmove(track->pitch, track->pitch + 1, (ATTITUDES - 1) * sizeof(double));
        --track->count;
    }
    track->time[track->count] = time;
    track->roll[track->count] = roll;
    track->pitch[track->count++] = level;
    return 1;
}

/* Roll and pitch at a time (s): between the two nearest attitudes, or the nearest one. Zero where there is none. */
static inline void attitude_at(const struct attitude_track *track, double time, double *roll, double *pitch)
{
    int32_t k = track->count - 1;

    *roll = *pitch = 0.0;
    if (k < 0)
        return;
    while (k > 0 && track->time[k] > time)
        --k;
    const int32_t next = k + 1 < track->count ? k + 1 : k;
    const double gap = track->time[next] - track->time[k];
    const double passed = time - track->time[k], share = gap > 0.0 ? clamped(passed / gap, 0.0, 1.0) : 0.0;
    *roll = track->roll[k] + share * (track->roll[next] - track->roll[k]);
    *pitch = track->pitch[k] + share * (track->pitch[next] - track->pitch[k]);
}

static inline int attitude_is_new(const struct attitude_track *track, time_stamp now)
{
    return track->count > 0 && now - track->time[track->count - 1] <= OLDEST_ATTITUDE;
}

/* The weight of the correction by this track now (s), so long (s) after the last sample; to be called once in each sample. */
static inline double attitude_weight(struct attitude_track *track, time_stamp now, double elapsed)
{
    const double target = attitude_is_new(track, now) ? 1.0 : 0.0, change = elapsed / FADE;

    track->weight = track->initialised ? track->weight + clamped(target - track->weight, -change, change) : target;
    track->initialised = 1;
    return track->weight;
}

#endif
