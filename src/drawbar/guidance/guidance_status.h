/* How guidance went. */
#ifndef DRAWBAR_GUIDANCE_STATUS_H
#define DRAWBAR_GUIDANCE_STATUS_H

enum guidance_status {
    GUIDANCE_FINE,
    GUIDANCE_FAR_FROM_START,               /* the tractor is further from the path's start than allowed, or nowhere */
    GUIDANCE_POSE_NOT_FINITE,              /* a body's position or yaw */
    GUIDANCE_SPEED_NOT_FINITE,
    GUIDANCE_NO_WAY                        /* the tractor faces away and no turns lead onto the path */
};

#endif
