/* How a host program reads and writes, on an operating system (files.c) or without one (semihosting.c). */
#ifndef HOST_H
#define HOST_H

#include <stddef.h>

/* Read or write this many bytes of the file "input" or "output"; return whether they were all there. */
int host_read(void *bytes, size_t size);
int host_write(const void *bytes, size_t size);

/* A step begins, and has ended: without an operating system its instructions are counted. */
void host_begin(void);
void host_end(void);

#endif
