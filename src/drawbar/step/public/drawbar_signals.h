/* Signals that enter and leave one control step. SI units, radians, x east, y north, yaw counter-clockwise from
 * east and continuous, steering left positive. A missing value is NaN; so is what a machine has no sensor for.
 *
 * Generated from signals/ and statuses.py by `python -m drawbar.signals.c_headers`; change them there. */
#ifndef DRAWBAR_SIGNALS_H
#define DRAWBAR_SIGNALS_H

#include <math.h>
#include <stdint.h>

/* What became of a control step; each status carries its text. Below REFUSED it is a set of flags (Flag). */
enum drawbar_status {
    DRAWBAR_OK = 0,                     /* done; of a step: with a new command */
    DRAWBAR_REFUSED = 64,               /* last command repeated: the new one is not finite or exceeds its limits */
    DRAWBAR_TIME = 65,                  /* last command repeated: the time stamp is not finite or does not
                                         * increase */
    DRAWBAR_POSITION = 66,              /* standing: the run cannot begin, an antenna's position is missing */
    DRAWBAR_START = 67,                 /* standing: the run cannot begin, the tractor is too far from where it is
                                         * to begin on the path */
    DRAWBAR_FINISHED = 128,             /* stopped: the tractor has reached the end of the path */
    DRAWBAR_OFF_COURSE = 129,           /* stopped: the tractor is too far from the path */
    DRAWBAR_BLIND = 130,                /* stopped: neither antenna has had a valid fix for too long */
    DRAWBAR_GUIDANCE = 131,             /* stopped: the estimate is not finite, or no turns lead back onto the
                                         * path */
    DRAWBAR_GAP = 132,                  /* stopped: samples were left out for longer than a command may be
                                         * repeated */
    DRAWBAR_STOPPED = 133,              /* stopped: no command could be given for longer than one may be repeated */
    DRAWBAR_UNSOLVED = 134,             /* stopped: estimator or controllers have had no solution for too long */
    DRAWBAR_OVERDUE = 135,              /* stopped: samples came late for too long */
    DRAWBAR_RATE = 136,                 /* stopped: samples come more often, or less often, than every sample_time */
    DRAWBAR_COARSE = 140,               /* stopped: positions have been coarse for too long */
    DRAWBAR_OSCILLATION = 141,          /* stopped: errors or steering swing from side to side */
    DRAWBAR_BACKWARDS = 142,            /* stopped: both antennas move backwards: they are swapped, or the vehicle
                                         * is driven in reverse */
    DRAWBAR_STEERING = 143,             /* stopped: a steering does not follow its commands: sensor or actuator
                                         * fails, or somebody steers */
    DRAWBAR_HITCH = 144,                /* stopped: the hitch angle contradicts the motion of both bodies */
    DRAWBAR_ROLL = 145,                 /* stopped: a roll sensor contradicts the other angles or the swing of its
                                         * antenna: it is reversed or stuck */
    DRAWBAR_JUMPED = 146,               /* stopped: both positions have jumped: base station or solution changed,
                                         * receivers swapped, or vehicle slides */
    DRAWBAR_NULL = 256,                 /* wrong call: a pointer is NULL */
    DRAWBAR_NOT_INITIALISED = 257,      /* wrong call: drawbar_init has not been called on this state */
    DRAWBAR_NO_PATH = 258,              /* wrong call: drawbar_set_path has not been called, or not with success */
    DRAWBAR_ORDER = 259,                /* wrong call: out of order: feedback and prepare alternate, and a run's
                                         * start is set before it begins */
    DRAWBAR_PATH = 260,                 /* wrong call: the path's table is not a smooth path */
    DRAWBAR_RANGE = 261,                /* wrong call: a number is beyond what is allowed */
    DRAWBAR_NO_RUN = 262,               /* wrong call: no run has begun, or it has ended */
    DRAWBAR_ELSEWHERE = 263,            /* wrong call: the vehicle is not on the new path at that place, or faces
                                         * away from it */
    DRAWBAR_UNALIGNED = 264,            /* wrong call: a pointer is not aligned as a double */
    DRAWBAR_ARITHMETIC = 265            /* wrong build: NaN or sums are not IEEE's */
};

/* Remarks on a step that made a new command; each flag carries its text. */
enum drawbar_flag {
    DRAWBAR_MEASUREMENT = 1,            /* a measured value was infinite or beyond what its sensor can mean, and
                                         * was taken for missing */
    DRAWBAR_LATE = 2,                   /* one or more samples were left out */
    DRAWBAR_LIMITED = 4,                /* steering clamped where the valve is already fully open; the motion is
                                         * unchanged */
    DRAWBAR_SOLVER = 8,                 /* a solver failed; the estimate or the plan is its own prediction */
    DRAWBAR_SLOWED = 16,                /* the vehicle is driven slower than the set speed, until estimates and
                                         * plans are sound again */
    DRAWBAR_RELEASED = 32               /* not engaged: the command repeats the steering as it is, with speed zero */
};

/* What an estimator made of one antenna's position fix. */
enum drawbar_fix {
    DRAWBAR_FIX_ACCEPTED = 0,
    DRAWBAR_FIX_MISSING = 1,            /* the receiver reported none */
    DRAWBAR_FIX_STALE = 2,              /* the receiver repeated an old one while the vehicle moved */
    DRAWBAR_FIX_REJECTED = 3            /* too far from the predicted position, or contradicted by the other
                                         * antenna */
};

/* How a receiver found a position. */
enum drawbar_quality {
    DRAWBAR_QUALITY_UNKNOWN = 0,        /* the receiver does not report it */
    DRAWBAR_QUALITY_NONE = 1,
    DRAWBAR_QUALITY_SINGLE = 2,         /* without corrections */
    DRAWBAR_QUALITY_DIFFERENTIAL = 3,
    DRAWBAR_QUALITY_FLOAT = 4,          /* RTK, ambiguities not resolved */
    DRAWBAR_QUALITY_FIXED = 5           /* RTK, ambiguities resolved */
};

/* Outcome of a solver call; the C runtime returns the same numbers. */
enum drawbar_solver {
    DRAWBAR_SOLVER_SOLVED = 0,
    DRAWBAR_SOLVER_MAXIMUM_ITERATIONS = 1,
    DRAWBAR_SOLVER_INFEASIBLE = 2,
    DRAWBAR_SOLVER_NOT_FINITE = 3,
    DRAWBAR_SOLVER_CHECK_FAILED = 4,
    DRAWBAR_SOLVER_BAD_INPUT = 5
};

/* What the gate made of a command. */
enum drawbar_gate {
    DRAWBAR_GATE_PASSED = 0,
    DRAWBAR_GATE_LIMITED = 1,           /* steering clamped where the valve is already fully open; the motion is
                                         * unchanged */
    DRAWBAR_GATE_REPEATED = 2,          /* refused: the last one that passed was repeated */
    DRAWBAR_GATE_STOPPED = 3            /* refused, and there was none to repeat, or none new enough: speed zero,
                                         * steering held */
};

/* How guidance went. */
enum drawbar_guidance {
    DRAWBAR_GUIDANCE_FINE = 0,
    DRAWBAR_GUIDANCE_FAR_FROM_START = 1, /* the tractor is too far from where the run is to begin, or its position
                                         * is missing */
    DRAWBAR_GUIDANCE_POSE_NOT_FINITE = 2, /* a body's position or yaw is not finite */
    DRAWBAR_GUIDANCE_SPEED_NOT_FINITE = 3,
    DRAWBAR_GUIDANCE_NO_WAY = 4         /* the tractor faces away and no turns lead onto the path */
};

/* One pose of a path's table. */
struct drawbar_path_node {
    double arc_length;                  /* from the path's start, m */
    double x;                           /* m */
    double y;                           /* m */
    double yaw;                         /* continuous along the path, rad */
};

/* What the sensors report at one instant; a missing value is NaN. What a machine lacks keeps its default. A value
 * with an age above 1 s is missing, and so is one of the future; up to 0.05 s of it count as now. */
struct drawbar_measurement {
    double time;                        /* of the sample, s */
    double tractor_x;                   /* east of the tractor antenna, m */
    double tractor_y;                   /* north of the tractor antenna, m */
    double trailer_x;                   /* east of the trailer antenna, m */
    double trailer_y;                   /* north of the trailer antenna, m */
    double hitch_angle;                 /* beta, tractor yaw minus drawbar yaw, rad */
    double speed;                       /* of the wheels, m/s */
    double tractor_steering;            /* delta_t, front wheels, left positive, rad */
    double trailer_steering;            /* delta_i, actuated joint between drawbar and trailer, rad */
    double tractor_fix_deviation;       /* standard deviation of each coordinate of the tractor's fix; 0 or less:
                                         * the fix is missing, m */
    double trailer_fix_deviation;       /* standard deviation of each coordinate of the trailer's fix; 0 or less:
                                         * the fix is missing, m */
    double tractor_roll;                /* right side down positive, rad */
    double tractor_pitch;               /* nose up positive, rad */
    double tractor_yaw;                 /* direction in which the tractor faces, from east, by a receiver with two
                                         * antennas on it, -2 pi to 2 pi, rad */
    double tractor_yaw_rate;            /* counter-clockwise positive, rad/s */
    double trailer_roll;                /* right side down positive, rad */
    double trailer_pitch;               /* nose up positive, rad */
    double trailer_yaw_rate;            /* counter-clockwise positive; recorded only, nothing uses it, rad/s */
    double tractor_fix_age;             /* of the tractor's position at the time of the sample; 0: not reported,
                                         * `sensors.fixes.age` is used, s */
    double trailer_fix_age;             /* of the trailer's position at the time of the sample; 0: not reported,
                                         * `sensors.fixes.age` is used, s */
    double hitch_angle_age;             /* of the hitch angle at the time of the sample, s */
    double speed_age;                   /* of the speed at the time of the sample, s */
    double tractor_steering_age;        /* of the tractor's steering angle at the time of the sample, s */
    double trailer_steering_age;        /* of the trailer's steering angle at the time of the sample, s */
    double tractor_attitude_age;        /* of the tractor's roll, pitch, yaw and yaw rate at the time of the
                                         * sample, s */
    double trailer_attitude_age;        /* of the trailer's roll, pitch and yaw rate at the time of the sample, s */
    int32_t tractor_fix_quality;        /* enum drawbar_quality */
    int32_t trailer_fix_quality;        /* enum drawbar_quality */
};

/* A measurement of nothing. Let every measurement begin as this, then write into it what the sensors report. Zeros are
 * something else: they report rates of zero, and fixes with a deviation of zero, which count as missing. */
#define DRAWBAR_NOTHING_MEASURED { \
    (double)NAN, (double)NAN, (double)NAN, (double)NAN, (double)NAN, (double)NAN, (double)NAN, \
    (double)NAN, (double)NAN, (double)NAN, (double)NAN, (double)NAN, (double)NAN, (double)NAN, \
    (double)NAN, (double)NAN, (double)NAN, (double)NAN, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, \
    DRAWBAR_QUALITY_UNKNOWN, DRAWBAR_QUALITY_UNKNOWN}

/* Position on the ground and continuous yaw of one body's point. */
struct drawbar_pose {
    double x;                           /* m */
    double y;                           /* m */
    double yaw;                         /* rad */
};

/* Estimated poses, joint angles, speed and slip factors at one time. */
struct drawbar_estimate {
    double time;                        /* of the measurement, s */
    struct drawbar_pose tractor;        /* of the middle of its rear axle, on the ground */
    struct drawbar_pose trailer;        /* of its tracked point, on the ground */
    double hitch_angle;                 /* beta, rad */
    double speed;                       /* v, of the wheels, m/s */
    double tractor_steering;            /* delta_t, rad */
    double trailer_steering;            /* delta_i, rad */
    double longitudinal_slip;           /* mu */
    double tractor_slip;                /* kappa, factor on the tractor's steering angle */
    double trailer_slip;                /* eta, factor on the trailer's steering angle; 1 where the model has none */
    double steering_offset;             /* b; 0 where the model has none, rad */
    double tractor_crab;                /* alpha_r, side-slip angle of the tractor's rear axle; 0 where the model
                                         * has none, rad */
    double trailer_crab;                /* alpha_i, side-slip angle of the trailer's axle; 0 where the model has
                                         * none, rad */
    double slide_east;                  /* side-slip angle to the east that a slope gives every axle; part of b
                                         * and of both alpha, rad */
    double slide_north;                 /* the same to the north, rad */
    double creep;                       /* side-slip angle per side acceleration in g that a curve gives every
                                         * axle; part of b and of both alpha */
    int32_t status;                     /* of the estimator's solver, enum drawbar_solver */
    int32_t tractor_fix;                /* enum drawbar_fix */
    int32_t trailer_fix;                /* enum drawbar_fix */
    int32_t reserved;
};

/* What the actuators are asked for. */
struct drawbar_command {
    double time;                        /* of the measurement that it answers, s */
    double tractor_steering;            /* front wheels, rad */
    double trailer_steering;            /* actuated joint, in the actuator's own sign: opposite to the joint's
                                         * where vehicle.joint_sign is -1, rad */
    double speed;                       /* of the wheels, m/s */
};

/* How one body is, and how its command came about. */
struct drawbar_body_diagnostics {
    double progress;                    /* of the body along the path, m */
    double lateral_error;               /* of the body from the path, left positive, m */
    double nominal;                     /* steering of the plan, rad */
    double ancillary;                   /* steering that answers the deviation from the plan, rad */
    double margin;                      /* 1 at the centre of the tube, 0 on its boundary; NaN: none is declared */
    int32_t saturated;                  /* the steering ended at its bound */
    int32_t solver;                     /* of the body's controller, enum drawbar_solver */
    int32_t fix;                        /* enum drawbar_fix */
    int32_t reserved;
};

/* Diagnostics of the last step. */
struct drawbar_diagnostics {
    struct drawbar_body_diagnostics tractor;
    struct drawbar_body_diagnostics trailer;
    double speed;                       /* commanded while the run goes on, m/s */
    double start_distance;              /* of the tractor from where the run is to begin, before it begins; NaN:
                                         * its position is missing, m */
    double unsolved;                    /* for how long estimator and controllers have not all had a solution, s */
    double overdue;                     /* what is left of the time by which samples came late, s */
    int32_t status;                     /* what drawbar_feedback returned, without the flags of a new command,
                                         * enum drawbar_status */
    int32_t flags;                      /* enum drawbar_flag */
    int32_t estimator;                  /* enum drawbar_solver */
    int32_t gate;                       /* enum drawbar_gate */
    int32_t guidance;                   /* enum drawbar_guidance */
    int32_t missing;                    /* measured values that were infinite or beyond what their sensors can
                                         * mean */
};

/* Identified dynamics of one steering from command to angle; zero where none are identified. */
struct drawbar_body_actuation {
    double dead_time;                   /* between a command and the first reaction, s */
    double dead_time_deviation;         /* standard deviation, s */
    double lag;                         /* time constant, s */
    double lag_deviation;               /* standard deviation, s */
    double rate;                        /* fastest that it turns, the stated rate at most, rad/s */
    double rate_deviation;              /* standard deviation, rad/s */
};

/* Identified dynamics of steerings and errors of sensors, and what plans assume; zero where none are identified. */
struct drawbar_actuation {
    struct drawbar_body_actuation tractor; /* front wheels */
    struct drawbar_body_actuation trailer; /* actuated joint */
    double dead_time;                   /* that plans assume, beside the lag of the body, s */
    double body_lag;                    /* by which the tractor turns later than its wheels stand: stated
                                         * (`actuation.body_lag_per_speed`), by the ground's creep, and as the
                                         * yaw-rate sensor identifies it; plans assume it, s */
    double body_lag_deviation;          /* standard deviation of the part that the yaw-rate sensor identifies, s */
    double tractor_lag;                 /* that plans assume, s */
    double trailer_lag;                 /* that plans assume, s */
    double tractor_rate;                /* that plans assume, rad/s */
    double trailer_rate;                /* that plans assume, rad/s */
    double fix_latency;                 /* identified by the yaw-rate sensor, beyond the age that receivers or
                                         * `sensors.fixes.age` state, s */
    double hitch_latency;               /* of the hitch angle, identified by the ways of both antennas, beyond its
                                         * reported age, s */
    double hitch_scale;                 /* identified scale error of the hitch sensor: true per measured angle,
                                         * less 1 */
    double joint_scale;                 /* identified scale error of the joint's sensor, by which its board
                                         * follows commands as well */
    double tractor_roll_offset;         /* identified zero of the tractor's roll sensor, beyond the stated offset,
                                         * rad */
    double tractor_roll_deviation;      /* standard deviation, rad */
    double trailer_roll_offset;         /* identified zero of the trailer's roll sensor, beyond the stated offset,
                                         * rad */
    double trailer_roll_deviation;      /* standard deviation, rad */
};

#endif
