/* Plans of the KUKA LBR iiwa from C and C++. Made by cbindgen from the crate iiwa-c: not to be edited.
 *
 * Functions that can fail return a status, and iiwasim_last_error says why: what is wrong, where in the program's text, and
 * what to do. Pointers that are NULL are refused. What functions write to a pointer's pointer is the caller's to free.
 * Units are SI and radians. */

#ifndef IIWASIM_H
#define IIWASIM_H

#include <stddef.h>
#include <stdint.h>

/*
 Status of a call.
 */
typedef enum IiwasimStatus {
  /*
   The call succeeded.
   */
  IIWASIM_STATUS_OK = 0,
  /*
   An argument is NULL or out of range.
   */
  IIWASIM_STATUS_ARGUMENT = 1,
  /*
   A file cannot be read.
   */
  IIWASIM_STATUS_FILE = 2,
  /*
   The program or the robot's profile is invalid.
   */
  IIWASIM_STATUS_PROGRAM = 3,
  /*
   The robot cannot perform the program.
   */
  IIWASIM_STATUS_PLAN = 4,
  /*
   A fault of this library; please report it.
   */
  IIWASIM_STATUS_INTERNAL = 5,
} IiwasimStatus;

/*
 Set of active limits.
 */
typedef enum IiwasimTiming {
  /*
   Velocity, acceleration and jerk.
   */
  IIWASIM_TIMING_JERK = 0,
  /*
   Velocity and acceleration.
   */
  IIWASIM_TIMING_ACCELERATION = 1,
  /*
   Jerk-limited, but with PTP motions and splines from rest to rest as Sunrise was observed to
   plan them: splines by a model.
   */
  IIWASIM_TIMING_SUNRISE = 2,
} IiwasimTiming;

/*
 Plan of a program. It is immutable, and may be used by several threads at once.
 */
typedef struct IiwasimPlan IiwasimPlan;

/*
 Motion program. It is immutable, and may be used by several threads at once.
 */
typedef struct IiwasimProgram IiwasimProgram;

/*
 Reason for the failure of the last call of this thread.
 */
typedef struct IiwasimError {
  /*
   Status that the call returned.
   */
  enum IiwasimStatus status;
  /*
   Line in the program's text, from 1; 0 if the error has no place in the text.
   */
  uint32_t line;
  /*
   Column in characters, from 1; 0 as for `line`.
   */
  uint32_t column;
  /*
   Motion of the program, from 1; 0 if the error concerns no motion.
   */
  uint32_t motion;
  /*
   Message with the fault, its place and its remedy, in UTF-8; empty after a call that
   succeeded.
   */
  const char *message;
} IiwasimError;

/*
 Planning options. `iiwasim_options_default` initialises them, so that unset fields have their
 default values.
 */
typedef struct IiwasimOptions {
  /*
   Name of a built-in robot, or the JSON text of a robot's profile; NULL for the robot that the
   program names.
   */
  const char *robot;
  /*
   Set of active limits: an `IiwasimTiming`.
   */
  int32_t timing;
  /*
   Samples per blend under `IIWASIM_TIMING_ACCELERATION`, 2 to 100000.
   */
  uint32_t samples;
  /*
   Torque limit, in per cent of the robot's; 0 for the program's own limit, if it has one.
   */
  double limit_torque_percent;
} IiwasimOptions;

/*
 State of the arm at one instant.
 */
typedef struct IiwasimState {
  /*
   Time, in s.
   */
  double t_s;
  /*
   Positions of A1 to A7, in rad.
   */
  double q[7];
  /*
   Velocities, in rad/s.
   */
  double dq[7];
  /*
   Accelerations, in rad/s^2. At jumps, the value after the jump.
   */
  double ddq[7];
  /*
   TCP position in the robot's base frame, in m. The TCP is that of the motion's tool, or the
   flange.
   */
  double tcp_m[3];
  /*
   TCP orientation in the robot's base frame, a unit quaternion x, y, z, w with w >= 0.
   */
  double tcp_xyzw[4];
  /*
   Motion of the program, from 1.
   */
  uint32_t motion;
} IiwasimState;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/*
 Writes the reason for the failure of the last call of this thread to `*error`. Its message is
 valid until the next call of this thread.

 Returns `IIWASIM_STATUS_ARGUMENT` if `error` is NULL, and keeps the error then.
 */
enum IiwasimStatus iiwasim_last_error(struct IiwasimError *error);

/*
 Writes the default options.
 */
enum IiwasimStatus iiwasim_options_default(struct IiwasimOptions *options);

/*
 Plans a program, and writes the plan to `*plan`: `iiwasim_plan_free` frees it. `*plan` is NULL
 after a failure. Without `options` (NULL) the default options apply.

 # Safety

 `options->robot` is NULL, or a string that ends with a NUL.
 */
enum IiwasimStatus iiwasim_plan(const struct IiwasimProgram *program,
                                const struct IiwasimOptions *options,
                                struct IiwasimPlan **plan);

/*
 Frees a plan; NULL is ignored.
 */
void iiwasim_plan_free(struct IiwasimPlan *plan);

/*
 Writes the cycle time to `*seconds`: from the start to the end of the last settle time or wait,
 in s.
 */
enum IiwasimStatus iiwasim_plan_cycle_time_s(const struct IiwasimPlan *plan, double *seconds);

/*
 Writes the state of the arm `t_s` after the start of the program to `*state`. Before the start
 and after the end the arm is at rest.
 */
enum IiwasimStatus iiwasim_plan_at(const struct IiwasimPlan *plan,
                                   double t_s,
                                   struct IiwasimState *state);

/*
 Writes the states of the arm at `rate_hz` samples per second to `states`, from the start to the
 end: the first sample is at 0, the last exactly at the cycle time. `*count` is the number of
 samples.

 With `states` NULL and `capacity` 0 the function only counts. If `capacity` is too small, it
 writes `capacity` states, and returns `IIWASIM_STATUS_ARGUMENT`.

 # Safety

 `states` is NULL, or has room for `capacity` states.
 */
enum IiwasimStatus iiwasim_plan_sample(const struct IiwasimPlan *plan,
                                       double rate_hz,
                                       struct IiwasimState *states,
                                       size_t capacity,
                                       size_t *count);

/*
 Writes the figures to `*json`: the object of `iiwasim plan --json`, without `output`.
 `iiwasim_string_free` frees it; `*json` is NULL after a failure.
 */
enum IiwasimStatus iiwasim_plan_figures_json(const struct IiwasimPlan *plan, char **json);

/*
 Writes the text files of an FMU that runs the plan to `*json`: an object with a text for each
 path. Together with this library as `binaries/PLATFORM/iiwasim.so`, `.dll` or `.dylib`, where
 FMI 3.0 defines the platform names, these files are the FMU. `iiwasim_string_free` frees the
 text; `*json` is NULL after a failure.

 # Safety

 `name`, the name of the model, is NULL, or a string in UTF-8 that ends with a NUL.
 */
enum IiwasimStatus iiwasim_plan_fmu_json(const struct IiwasimPlan *plan,
                                         const char *name,
                                         char **json);

/*
 Reads a program from its JSON text, and writes it to `*program`: `iiwasim_program_free` frees
 it. `*program` is NULL after a failure.

 Use `iiwasim_program_load` for a program that includes a file, or names the file of a robot's
 profile.

 # Safety

 `json` is NULL, or a string that ends with a NUL.
 */
enum IiwasimStatus iiwasim_program_from_json(const char *json, struct IiwasimProgram **program);

/*
 Reads a program from a file, with the files that it includes or names as its robot's profile,
 and writes it to `*program`: `iiwasim_program_free` frees it. `*program` is NULL after a
 failure.

 # Safety

 `path` is NULL, or a string in UTF-8 that ends with a NUL.
 */
enum IiwasimStatus iiwasim_program_load(const char *path, struct IiwasimProgram **program);

/*
 Frees a program; NULL is ignored. Plans of this program remain valid.
 */
void iiwasim_program_free(struct IiwasimProgram *program);

/*
 Returns the version of the library, such as `0.1.0`. It must not be freed.
 */
const char *iiwasim_version(void);

/*
 Frees a string written by a function of this library; NULL is ignored.

 # Safety

 `string` is NULL, or was written by this library and has not been freed yet.
 */
void iiwasim_string_free(char *string);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* IIWASIM_H */
