/* Lever arm, from an antenna to the point on the ground that its body is known by (docs/theory/lever-arm.md). */
#ifndef DRAWBAR_LEVER_ARM_H
#define DRAWBAR_LEVER_ARM_H

#include <math.h>

struct mast {
    double forward, left, up;              /* of the antenna from the point, along the body's axes, m */
    double roll_offset, pitch_offset;      /* what the attitude sensor shows while the body stands level, rad */
    double roll_deviation;                 /* standard deviation of the roll offset, rad */
};

#define MAST_FIELDS(type, place)                                                                             \
    SETTING(type, place.forward, 0, 1, 0, 0) SETTING(type, place.left, 0, 1, 0, 0)                           \
    SETTING(type, place.up, 0, 1, 0, 0) SETTING(type, place.roll_offset, 0, 1, 0, 0)                         \
    SETTING(type, place.pitch_offset, 0, 1, 0, 0) SETTING(type, place.roll_deviation, 0, 1, 0, 0)

/* How far east and north of its body's point an antenna stands, m, where the body is turned by R = Rz(yaw) Ry(-pitch)
 * Rx(roll): roll right side down positive, pitch nose up positive, rad. */
static inline void lever_arm(const struct mast *mast, double yaw, double roll, double pitch, double *offset)
{
    const double raised = mast->left * sin(roll) + mast->up * cos(roll);
    const double ahead = mast->forward * cos(pitch) - raised * sin(pitch);
    const double beside = mast->left * cos(roll) - mast->up * sin(roll);

    offset[0] = ahead * cos(yaw) - beside * sin(yaw);
    offset[1] = ahead * sin(yaw) + beside * cos(yaw);
}

/* Whether the antenna stands over its point whichever way the body leans: then nothing is to be corrected. */
static inline int mast_is_none(const struct mast *mast)
{
    return mast->forward == 0.0 && mast->left == 0.0 && mast->up == 0.0;
}

/* Whether the antenna sways as the ground is uneven, without anything that tells; roll: of the body, rad, NaN: unknown. */
static inline int mast_sways(const struct mast *mast, double roll)
{
    return mast->up > 0.0 && isnan(roll);
}

#endif
