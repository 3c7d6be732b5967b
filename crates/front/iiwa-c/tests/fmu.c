/* Two instances of an FMU in one library, call by call, for valgrind: fmu TOKEN RESOURCES STEPS
 * Prints A4 of both after so many steps of 10 ms, of which the second one begins after half of them. */

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef void (*Log)(void *environment, int status, const char *category, const char *message);

void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *resources, bool visible, bool logging,
                                  bool event_mode, bool early_return, const uint32_t *intermediate, size_t n_intermediate,
                                  void *environment, Log log, void *update);
void fmi3FreeInstance(void *instance);
int fmi3EnterInitializationMode(void *instance, bool tolerance_defined, double tolerance, double start,
                                bool stop_defined, double stop);
int fmi3ExitInitializationMode(void *instance);
int fmi3Terminate(void *instance);
int fmi3Reset(void *instance);
int fmi3DoStep(void *instance, double time, double step, bool no_set_state, bool *event, bool *terminate, bool *early,
               double *last);
int fmi3GetFloat64(void *instance, const uint32_t *references, size_t n, double *values, size_t n_values);
int fmi3SetFloat64(void *instance, const uint32_t *references, size_t n, const double *values, size_t n_values);
int fmi3SetBoolean(void *instance, const uint32_t *references, size_t n, const bool *values, size_t n_values);
int fmi3GetFMUState(void *instance, void **state);
int fmi3SetFMUState(void *instance, void *state);
int fmi3FreeFMUState(void *instance, void **state);
int fmi3GetInt64(void *instance, const uint32_t *references, size_t n, int64_t *values, size_t n_values);

enum { OK = 0, DISCARD = 2, ERROR = 3 };
static const uint32_t START = 1, OVERRIDE = 2, Q4 = 6;
static int messages = 0;

static void keep(void *environment, int status, const char *category, const char *message) {
    (void)category;
    messages += strlen(message) > 0 && status >= DISCARD && environment == &messages;
}

static void expect(int found, int wanted, const char *what) {
    if (found != wanted) {
        fprintf(stderr, "%s: %d, expected %d\n", what, found, wanted);
        exit(EXIT_FAILURE);
    }
}

static void step(void *instance, double time) {
    bool event, terminate, early;
    double last;
    expect(fmi3DoStep(instance, time, 0.01, true, &event, &terminate, &early, &last), OK, "step");
    expect(event || terminate || early || last != time + 0.01, 0, "what a step says");
}

static double a4(void *instance) {
    double value;
    expect(fmi3GetFloat64(instance, &Q4, 1, &value, 1), OK, "get");
    return value;
}

static void begin(void *instance) {
    expect(fmi3EnterInitializationMode(instance, false, 0.0, 0.0, false, 0.0), OK, "initialise");
    expect(fmi3ExitInitializationMode(instance), OK, "initialised");
}

int main(int argc, char **argv) {
    expect(argc, 4, "arguments");
    const int steps = atoi(argv[3]);
    const bool yes = true;
    void *instances[2];
    for (int i = 0; i < 2; i++) {
        instances[i] = fmi3InstantiateCoSimulation("arm", argv[1], argv[2], false, false, false, false, NULL, 0, &messages,
                                                   keep, NULL);
        expect(instances[i] != NULL, true, "instantiate");
        begin(instances[i]);
    }
    void *state = NULL;
    for (int i = 0; i < steps; i++) {
        if (i == 0 || i == steps / 2) {
            expect(fmi3SetBoolean(instances[i > 0], &START, 1, &yes, 1), OK, "start");
            expect(fmi3GetFMUState(instances[i > 0], &state), OK, "state");
        }
        step(instances[0], 0.01 * i);
        step(instances[1], 0.01 * i);
    }
    printf("%.17g %.17g\n", a4(instances[0]), a4(instances[1]));
    /* The second one from its beginning again. */
    expect(fmi3SetFMUState(instances[1], state), OK, "back");
    for (int i = steps / 2; i < steps; i++) {
        step(instances[1], 0.01 * i);
    }
    printf("%.17g\n", a4(instances[1]));
    expect(fmi3FreeFMUState(instances[1], &state), OK, "free");
    expect(state == NULL, true, "freed");

    const double twice = 2.0;
    int64_t none;
    expect(fmi3SetFloat64(instances[0], &OVERRIDE, 1, &twice, 1), DISCARD, "a bad override");
    expect(fmi3SetFloat64(instances[0], NULL, 1, &twice, 1), ERROR, "no references");
    expect(fmi3GetFloat64(instances[0], &Q4, 1, NULL, 1), ERROR, "no place");
    expect(fmi3GetInt64(instances[0], &Q4, 1, &none, 1), ERROR, "another type");
    expect(fmi3GetFMUState(instances[0], NULL), ERROR, "no place for a state");
    expect(fmi3Reset(NULL), ERROR, "no instance");
    expect(fmi3InstantiateCoSimulation("arm", "another", argv[2], false, false, false, false, NULL, 0, &messages, keep,
                                       NULL) == NULL, true, "another token");
    expect(fmi3InstantiateCoSimulation("arm", argv[1], NULL, false, false, false, false, NULL, 0, &messages, keep,
                                       NULL) == NULL, true, "no resources");
    expect(messages, 7, "messages");
    expect(fmi3Reset(instances[0]), OK, "reset");
    begin(instances[0]);
    step(instances[0], 0.0);
    expect(fmi3Terminate(instances[0]), OK, "terminate");
    for (int i = 0; i < 2; i++) {
        fmi3FreeInstance(instances[i]);
    }
    fmi3FreeInstance(NULL);
    return EXIT_SUCCESS;
}
