/* DRAWBAR_API marks the public functions of this library. */
#ifndef DRAWBAR_API_H
#define DRAWBAR_API_H

#if defined(__GNUC__) && !defined(_WIN32)  /* of a shared library's functions only these are seen from outside */
#define DRAWBAR_API __attribute__((visibility("default")))
#else
#define DRAWBAR_API                        /* Windows: drawbar.def lists the exported functions */
#endif

#endif
