/* Plans a program, and prints where the arm is: plan_c PROGRAM.json [RATE_HZ] */

#include <iiwasim.h>
#include <stdio.h>
#include <stdlib.h>

/* Prints why the last call failed. */
static void print_error(const char *file) {
    IiwasimError error;
    if (iiwasim_last_error(&error) == IIWASIM_STATUS_OK) {
        fprintf(stderr, "%s:%u:%u: %s\n", file, error.line, error.column, error.message);
    }
}

static IiwasimStatus print_samples(const IiwasimPlan *plan, double rate_hz) {
    size_t count = 0;
    IiwasimStatus status = iiwasim_plan_sample(plan, rate_hz, NULL, 0, &count);
    if (status != IIWASIM_STATUS_OK) {
        return status;
    }
    IiwasimState *states = malloc(count * sizeof *states);
    if (states == NULL) {
        fprintf(stderr, "no memory for %zu samples\n", count);
        exit(EXIT_FAILURE);
    }
    status = iiwasim_plan_sample(plan, rate_hz, states, count, &count);
    for (size_t i = 0; status == IIWASIM_STATUS_OK && i < count; i++) {
        const IiwasimState *state = &states[i];
        printf("%7.3f s  motion %u  A4 %8.5f rad %8.5f rad/s  TCP %7.4f %7.4f %7.4f m\n", state->t_s, state->motion,
               state->q[3], state->dq[3], state->tcp_m[0], state->tcp_m[1], state->tcp_m[2]);
    }
    free(states);
    return status;
}

int main(int argc, char **argv) {
    if (argc < 2) {
        fprintf(stderr, "usage: %s PROGRAM.json [RATE_HZ]\n", argv[0]);
        return EXIT_FAILURE;
    }
    IiwasimProgram *program = NULL;
    IiwasimPlan *plan = NULL;
    char *figures = NULL;
    double cycle_time_s = 0.0;
    IiwasimOptions options;

    IiwasimStatus status = iiwasim_options_default(&options);
    options.timing = IIWASIM_TIMING_SUNRISE;
    if (status == IIWASIM_STATUS_OK) {
        status = iiwasim_program_load(argv[1], &program);
    }
    if (status == IIWASIM_STATUS_OK) {
        status = iiwasim_plan(program, &options, &plan);
    }
    if (status == IIWASIM_STATUS_OK) {
        status = iiwasim_plan_cycle_time_s(plan, &cycle_time_s);
    }
    if (status == IIWASIM_STATUS_OK) {
        printf("iiwasim %s: %.3f s\n", iiwasim_version(), cycle_time_s);
        status = print_samples(plan, argc > 2 ? atof(argv[2]) : 1.0);
    }
    if (status == IIWASIM_STATUS_OK) {
        status = iiwasim_plan_figures_json(plan, &figures);
    }
    if (status == IIWASIM_STATUS_OK) {
        printf("%s\n", figures);
    } else {
        print_error(argv[1]);
    }
    /* What is NULL is left alone. */
    iiwasim_string_free(figures);
    iiwasim_plan_free(plan);
    iiwasim_program_free(program);
    return status == IIWASIM_STATUS_OK ? EXIT_SUCCESS : EXIT_FAILURE;
}
