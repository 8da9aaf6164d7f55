/* Steps the exported library through a recording, on any target.
 *
 * Input, little-endian: number of nodes, a double; the nodes of the path; measurements, until the end.
 * Output, all doubles: the status of drawbar_set_path; then, for each measurement, the status of the step and the command's
 * 4 values.
 */
#include "drawbar.h"
#include "host.h"

#define NODES 8192

static struct drawbar_state state;
static struct drawbar_path_node nodes[NODES];

static int read_path(int32_t *count)
{
    double wanted;

    if (!host_read(&wanted, sizeof wanted) || !(wanted >= 0.0 && wanted <= NODES))
        return 0;
    *count = (int32_t)wanted;
    return host_read(nodes, (size_t)*count * sizeof nodes[0]);
}

static int write_step(int status, const struct drawbar_command *command)
{
    const double code = status;

    return host_write(&code, sizeof code) && host_write(command, sizeof *command);
}

int main(void)
{
    struct drawbar_measurement measurement;
    struct drawbar_command command;
    int32_t count;
    double code;

    if (!read_path(&count) || drawbar_init(&state) != DRAWBAR_OK)
        return 1;
    code = drawbar_set_path(&state, nodes, count);
    if (!host_write(&code, sizeof code))
        return 2;
    while (host_read(&measurement, sizeof measurement)) {
        host_begin();
        const int status = drawbar_step(&state, &measurement, &command);
        host_end();
        if (!write_step(status, &command))
            return 3;
    }
    return 0;
}
