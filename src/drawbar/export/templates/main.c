/* Replay recorded measurements through the controller:
 *
 *     drawbar_example measurements.csv [path.csv] > commands.csv
 *
 * measurements.csv: one line of names, then one line for each sample: time, tractor_x, tractor_y, trailer_x, trailer_y,
 *     hitch_angle, speed, tractor_steering, trailer_steering; s, m, rad, m/s; an empty value is missing
 * path.csv: one line of names, then one line for each node: arc_length, x, y, yaw; m, rad
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drawbar.h"

#define LINE 1024
#define MEASURED 9
#define NODE 4

static struct drawbar_state state;         /* too large for a microcontroller's stack */

/* Read numbers between commas; what is no number is NaN. */
static void read_numbers(const char *line, double *values, int count)
{
    for (int i = 0; i < count; ++i) {
        char *end;
        const double value = strtod(line, &end);
        values[i] = end != line && strchr(",\r\n", *end) != NULL ? value : (double)NAN;
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
        double values[NODE];
        if (*count % 1024 == 0)
            nodes = realloc(nodes, ((size_t)*count + 1024) * sizeof *nodes);
        if (nodes == NULL)
            exit(2);
        read_numbers(line, values, NODE);
        nodes[*count] = (struct drawbar_path_node){values[0], values[1], values[2], values[3]};
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
    double v[MEASURED];

    read_numbers(line, v, MEASURED);
    return (struct drawbar_measurement){v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7], v[8]};
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
        printf("%.17g,%.17g,%.17g,%.17g,%d,%s\n", command.time, command.tractor_steering, command.trailer_steering,
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
