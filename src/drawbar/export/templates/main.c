/* Replay recorded measurements through the controller:
 *
 *     drawbar_example measurements.csv [path.csv] > commands.csv
 *
 * measurements.csv: one line of names, then one line for each sample: the members of struct drawbar_measurement in their
 *     order, in its units. What is empty, or behind the end of the line, is as in DRAWBAR_NOTHING_MEASURED.
 * path.csv: one line of names, then one line for each node: the members of struct drawbar_path_node
 */
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drawbar.h"

#define LINE 2048
#define NODE (sizeof(struct drawbar_path_node) / sizeof(double))
/* Of a measurement, its numbers behind the time, and the integers behind them. */
#define FIRST offsetof(struct drawbar_measurement, tractor_x)
#define BEHIND offsetof(struct drawbar_measurement, tractor_fix_quality)
#define NUMBERS ((BEHIND - FIRST) / sizeof(double))
#define INTEGERS ((sizeof(struct drawbar_measurement) - BEHIND) / sizeof(int32_t))

static struct drawbar_state state;         /* too large for a microcontroller's stack */

/* Read numbers between commas; where there is none the value stays. */
static void read_numbers(const char *line, double *values, size_t count)
{
    for (size_t i = 0; i < count; ++i) {
        char *end;
        const double value = (double)strtod(line, &end);
        if (end != line && strchr(",\r\n", *end) != NULL)
            values[i] = value;
        line += strcspn(line, ",");
        line += *line == ',';
    }
}

static FILE *open_table(const char *name)
{
    char names[LINE];
    FILE *file = fopen(name, "r");

    if (file == NULL || fgets(names, LINE, file) == NULL) {
        fprintf(stderr, "%s: cannot be read\n", name);
        exit(2);
    }
    return file;
}

/* Return the path's nodes, which stay allocated until the program ends. */
static struct drawbar_path_node *read_path(const char *name, int32_t *count)
{
    char line[LINE];
    FILE *file = open_table(name);
    struct drawbar_path_node *nodes = NULL;

    *count = 0;
    while (fgets(line, LINE, file) != NULL) {
        double values[NODE] = {(double)NAN, (double)NAN, (double)NAN, (double)NAN};
        if (*count % 1024 == 0)
            nodes = realloc(nodes, ((size_t)*count + 1024) * sizeof *nodes);
        if (nodes == NULL)
            exit(2);
        read_numbers(line, values, NODE);
        memcpy(&nodes[*count], values, sizeof values);
        ++*count;
    }
    fclose(file);
    if (nodes == NULL) {
        fprintf(stderr, "%s: holds no nodes\n", name);
        exit(2);
    }
    return nodes;
}

static struct drawbar_measurement read_measurement(const char *line)
{
    struct drawbar_measurement measurement = DRAWBAR_NOTHING_MEASURED;
    double values[NUMBERS + INTEGERS] = {0.0};
    int32_t integers[INTEGERS];
    char *end;
    const double time = strtod(line, &end);

    if (end != line)
        measurement.time = time;
    line += strcspn(line, ",");
    line += *line == ',';
    memcpy(values, (char *)&measurement + FIRST, NUMBERS * sizeof *values);
    read_numbers(line, values, NUMBERS + INTEGERS);
    for (size_t i = 0; i < INTEGERS; ++i) {
        const double value = values[NUMBERS + i];
        integers[i] = fabs(value) < 1e9 ? (int32_t)value : 0;   /* what is no such number is not known */
    }
    memcpy((char *)&measurement + FIRST, values, NUMBERS * sizeof *values);
    memcpy((char *)&measurement + BEHIND, integers, sizeof integers);
    return measurement;
}

static int replay(const char *name)
{
    char line[LINE];
    FILE *file = open_table(name);

    printf("time,tractor_steering,trailer_steering,speed,status,meaning\n");
    while (fgets(line, LINE, file) != NULL) {
        const struct drawbar_measurement measurement = read_measurement(line);
        struct drawbar_command command;
        const int status = drawbar_feedback(&state, &measurement, &command);
        printf("%.17g,%.17g,%.17g,%.17g,%d,\"%s\"\n", command.time, command.tractor_steering, command.trailer_steering,
               command.speed, status, drawbar_status_text(status));
        drawbar_prepare(&state);           /* on a vehicle: after the command is out */
    }
    return fclose(file);
}

int main(int argc, char **argv)
{
    int32_t count;

    if (argc < 2 || argc > 3) {
        fprintf(stderr, "usage: %s measurements.csv [path.csv]\n", argv[0]);
        return 2;
    }
    if (strcmp(drawbar_version(), DRAWBAR_VERSION) != 0) {
        fprintf(stderr, "compiled for %s, linked with %s\n", DRAWBAR_VERSION, drawbar_version());
        return 2;
    }
    const struct drawbar_path_node *nodes = read_path(argc > 2 ? argv[2] : "path.csv", &count);
    int status = drawbar_init(&state);
    if (status == DRAWBAR_OK)
        status = drawbar_set_path(&state, nodes, count);
    if (status != DRAWBAR_OK) {
        fprintf(stderr, "%s\n", drawbar_status_text(status));
        return 2;
    }
    return replay(argv[1]);
}
