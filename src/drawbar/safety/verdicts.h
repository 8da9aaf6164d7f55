/* What gate and supervisor decide; autopilot/gate.py and autopilot/supervisor.py have the same ones. */
#ifndef DRAWBAR_VERDICTS_H
#define DRAWBAR_VERDICTS_H

enum gate_verdict {
    PASSED,
    LIMITED,                               /* its steering nearer to the wheels, but no actuator can tell */
    REPEATED,                              /* the last command that passed */
    STOPPED                                /* there is none, or it is too old: speed zero, steering held */
};

enum supervision {
    ON_COURSE,
    OFF_COURSE,                            /* the tractor is too far from the path, or nowhere */
    BLIND                                  /* neither antenna has had a fix for too long */
};

#endif
