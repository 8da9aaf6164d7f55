/* Ground record: the slope under the tractor, for the trailer that passes the same place later.
 *
 * Roll and pitch of a body are the ground's slope across and along it. The slope is recorded as a vector, east and north, with
 * its place, and interpolated between the two nearest records. Where nothing was recorded nearby it is the mean slope of the
 * last metres.
 */
#ifndef DRAWBAR_GROUND_RECORD_H
#define DRAWBAR_GROUND_RECORD_H

#include <stdint.h>
#include <string.h>
#include "geometry.h"

#define PLACES 64                          /* records that are kept */
#define NEARBY 0.6                         /* furthest that the trailer's axle may run beside the tractor's, m */
#define MEAN_OVER 20.0                     /* distance that the mean slope covers, m */
#define MOST_MOVED 1.0                     /* largest weight of one record in it, m: no jump after a gap */

struct ground_place {
    double x, y;                           /* m */
    double slope[2];                       /* rise per metre to the east and to the north */
};

struct ground_record {
    double spacing;                        /* least distance of two records, m */
    struct ground_place places[PLACES];    /* a ring */
    double mean[2];                        /* slope */
    int32_t count, newest;
};

/* The slope (rise per metre, east and north) below a body with this yaw, roll and pitch, rad. */
static inline void slope_below(double yaw, double roll, double pitch, double *slope)
{
    const double along = tan(pitch), across = tan(roll);

    slope[0] = along * cos(yaw) - across * sin(yaw);
    slope[1] = along * sin(yaw) + across * cos(yaw);
}

/* Roll and pitch of a body with this yaw on a slope, rad. */
static inline void lean_on(const double *slope, double yaw, double *roll, double *pitch)
{
    *pitch = atan(slope[0] * cos(yaw) + slope[1] * sin(yaw));
    *roll = atan(slope[1] * cos(yaw) - slope[0] * sin(yaw));
}

/* Record the slope at a place (m), where the last record is far enough away. */
static inline void ground_record_slope(struct ground_record *record, double x, double y, const double *slope)
{
    const struct ground_place *last = &record->places[record->newest];
    const double moved = record->count ? hypot(x - last->x, y - last->y) : record->spacing;

    if (!isfinite(x + y + slope[0] + slope[1]) || !(moved >= record->spacing))
        return;
    const double share = record->count ? fmin(moved, MOST_MOVED) / MEAN_OVER : 1.0;
    record->newest = (record->newest + (record->count > 0)) % PLACES;
    record->places[record->newest] = (struct ground_place){x, y, {slope[0], slope[1]}};
    record->count += record->count < PLACES;
    for (int i = 0; i < 2; ++i)
        record->mean[i] += share * (slope[i] - record->mean[i]);
}

/* Squared distance of a place from the stretch between two records, and how far along that is: 0 .. 1. */
static inline double ground_aside(const struct ground_place *from, const struct ground_place *to, double x, double y,
                                  double *share)
{
    const double east = to->x - from->x, north = to->y - from->y, length = east * east + north * north;
    const double along = length > 0.0 ? ((x - from->x) * east + (y - from->y) * north) / length : 0.0;

    *share = clamped(along, 0.0, 1.0);
    const double dx = x - from->x - *share * east, dy = y - from->y - *share * north;
    return dx * dx + dy * dy;
}

/* The slope that was recorded nearest to a place; returns 0 where that is too far away. */
static inline int ground_nearby(const struct ground_record *record, double x, double y, double *slope)
{
    double nearest = NEARBY * NEARBY;
    int found = 0;

    for (int32_t age = 1; age < record->count; ++age) {
        const struct ground_place *to = &record->places[(record->newest + PLACES - age + 1) % PLACES];
        const struct ground_place *from = &record->places[(record->newest + PLACES - age) % PLACES];
        double share;
        const double aside = ground_aside(from, to, x, y, &share);
        if (aside <= nearest) {
            nearest = aside;
            found = 1;
            for (int i = 0; i < 2; ++i)
                slope[i] = from->slope[i] + share * (to->slope[i] - from->slope[i]);
        }
    }
    return found;
}

/* The slope at a place. `local` is the weight of the recorded slope against the mean, which changes gradually, so that nothing
 * jumps; `elapsed` (s) since the last call; `recorded`: the recording body has passed this place. */
static inline void ground_slope(const struct ground_record *record, double x, double y, int recorded, double elapsed,
                                double *local, double *slope)
{
    double nearby[2] = {record->mean[0], record->mean[1]};
    const double target = recorded && ground_nearby(record, x, y, nearby) ? 1.0 : 0.0;

    *local += clamped(target - *local, -elapsed, elapsed);
    for (int i = 0; i < 2; ++i)
        slope[i] = record->mean[i] + *local * (nearby[i] - record->mean[i]);
}

#endif
