/* Settings of a component, written into it as they are known from the configuration. */
#ifndef DRAWBAR_SETTINGS_H
#define DRAWBAR_SETTINGS_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* Rows that are alike, one behind the other. */
struct setting {
    size_t offset;                         /* of the first row in the component, bytes */
    int32_t first, width, rows;            /* the row among the values, how long it is, how often it comes */
};

static inline void settings_write(void *component, const struct setting *settings, int32_t count, const void *values,
                                  size_t size)
{
    for (int32_t i = 0; i < count; ++i) {
        const char *row = (const char *)values + size * (size_t)settings[i].first;
        const size_t length = size * (size_t)settings[i].width;
        for (int32_t k = 0; k < settings[i].rows; ++k)
            memcpy((char *)component + settings[i].offset + length * (size_t)k, row, length);
    }
}

#define WRITE_SETTINGS(component, settings, values)                                                               \
    settings_write(component, settings, (int32_t)(sizeof settings / sizeof *settings), values, sizeof *values)

#endif
