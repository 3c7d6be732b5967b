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
 Whether a call has done what it is for.
 */
typedef enum IiwasimStatus {
  /*
   It has.
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
   The program or the robot's profile is not valid.
   */
  IIWASIM_STATUS_PROGRAM = 3,
  /*
   The robot cannot do what the program asks for.
   */
  IIWASIM_STATUS_PLAN = 4,
  /*
   A fault of this library; please report it.
   */
  IIWASIM_STATUS_INTERNAL = 5,
} IiwasimStatus;

/*
 Which limits are kept.
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
   As jerk-limited, but PTP motions and splines from rest to rest as Sunrise was seen to plan them: splines by a model.
   */
  IIWASIM_TIMING_SUNRISE = 2,
} IiwasimTiming;

/*
 A program's plan. It does not change, and may be used by several threads at once.
 */
typedef struct IiwasimPlan IiwasimPlan;

/*
 A motion program. It does not change, and may be used by several threads at once.
 */
typedef struct IiwasimProgram IiwasimProgram;

/*
 Why the last call of this thread failed.
 */
typedef struct IiwasimError {
  /*
   What it returned.
   */
  enum IiwasimStatus status;
  /*
   Line of the program's text, from 1; 0 if it is about no place in it.
   */
  uint32_t line;
  /*
   Column in characters, from 1; 0 as for `line`.
   */
  uint32_t column;
  /*
   The motion of the program, from 1; 0 if it is about none.
   */
  uint32_t motion;
  /*
   What is wrong, where, and what to do; in UTF-8, empty after a call that succeeded.
   */
  const char *message;
} IiwasimError;

/*
 How a program is planned. `iiwasim_options_default` fills it in, so that fields that are not set mean what is usual.
 */
typedef struct IiwasimOptions {
  /*
   A built-in robot's name, or the JSON text of a robot's profile; NULL for the robot that the program names.
   */
  const char *robot;
  /*
   Which limits are kept: an `IiwasimTiming`.
   */
  int32_t timing;
  /*
   Samples per blend under `IIWASIM_TIMING_ACCELERATION`, 2 to 100000.
   */
  uint32_t samples;
  /*
   Limit of torques, in per cent of the robot's; 0 for the program's own limit, if it has one.
   */
  double limit_torque_percent;
} IiwasimOptions;

/*
 What the arm does at one instant.
 */
typedef struct IiwasimState {
  /*
   When, in s.
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
   Accelerations, in rad/s^2. Where they jump, the value after the jump.
   */
  double ddq[7];
  /*
   Position of the TCP in the robot's base frame, in m. The TCP is that of the motion's tool, or the flange.
   */
  double tcp_m[3];
  /*
   Its orientation there, a unit quaternion x, y, z, w with w >= 0.
   */
  double tcp_xyzw[4];
  /*
   The motion of the program, from 1.
   */
  uint32_t motion;
} IiwasimState;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/*
 Writes why the last call of this thread failed to `*error`. Its message stays as it is until the next call of this thread.

 Returns `IIWASIM_STATUS_ARGUMENT` if `error` is NULL, and keeps the error then.
 */
enum IiwasimStatus iiwasim_last_error(struct IiwasimError *error);

/*
 Writes the options that are used where none are given.
 */
enum IiwasimStatus iiwasim_options_default(struct IiwasimOptions *options);

/*
 Plans a program, and writes the plan to `*plan`: `iiwasim_plan_free` frees it. `*plan` is NULL where it fails. Without
 `options` (NULL) it is planned with the default ones.

 # Safety

 `options->robot` is NULL, or a string that ends with a NUL.
 */
enum IiwasimStatus iiwasim_plan(const struct IiwasimProgram *program,
                                const struct IiwasimOptions *options,
                                struct IiwasimPlan **plan);

/*
 Frees a plan; NULL is left alone.
 */
void iiwasim_plan_free(struct IiwasimPlan *plan);

/*
 Writes the cycle time to `*seconds`: from the start to the end of the last settling or waiting, in s.
 */
enum IiwasimStatus iiwasim_plan_cycle_time_s(const struct IiwasimPlan *plan,
                                             double *seconds);

/*
 Writes what the arm does `t_s` after the start of the program to `*state`. Before the start and after the end it stands.
 */
enum IiwasimStatus iiwasim_plan_at(const struct IiwasimPlan *plan,
                                   double t_s,
                                   struct IiwasimState *state);

/*
 Writes what the arm does `rate_hz` times a second to `states`, from the start to the end: the first sample is at 0, the
 last exactly at the cycle time. `*count` is how many there are.

 With `states` NULL and `capacity` 0 it only counts. Where there is room for fewer states, it writes as many, and returns
 `IIWASIM_STATUS_ARGUMENT`.

 # Safety

 `states` is NULL, or has room for `capacity` states.
 */
enum IiwasimStatus iiwasim_plan_sample(const struct IiwasimPlan *plan,
                                       double rate_hz,
                                       struct IiwasimState *states,
                                       size_t capacity,
                                       size_t *count);

/*
 Writes the figures to `*json`: the object of `iiwasim plan --json`, without `output`. `iiwasim_string_free` frees it;
 `*json` is NULL where it fails.
 */
enum IiwasimStatus iiwasim_plan_figures_json(const struct IiwasimPlan *plan,
                                             char **json);

/*
 Writes the text files of an FMU that does what is planned to `*json`: an object with a text for each path. Together with
 this library as `binaries/PLATFORM/iiwasim.so`, `.dll` or `.dylib`, as FMI 3.0 names the platform, they are the FMU.
 `iiwasim_string_free` frees it; `*json` is NULL where it fails.

 # Safety

 `name`, the model's, is NULL, or a string in UTF-8 that ends with a NUL.
 */
enum IiwasimStatus iiwasim_plan_fmu_json(const struct IiwasimPlan *plan,
                                         const char *name,
                                         char **json);

/*
 Reads a program from its JSON text, and writes it to `*program`: `iiwasim_program_free` frees it. `*program` is NULL
 where it fails.

 A program that includes a file, or names a robot's profile by its file, is loaded by `iiwasim_program_load`.

 # Safety

 `json` is NULL, or a string that ends with a NUL.
 */
enum IiwasimStatus iiwasim_program_from_json(const char *json,
                                             struct IiwasimProgram **program);

/*
 Reads a program from a file, with the files beside it that it includes or names as its robot's profile, and writes it to
 `*program`: `iiwasim_program_free` frees it. `*program` is NULL where it fails.

 # Safety

 `path` is NULL, or a string in UTF-8 that ends with a NUL.
 */
enum IiwasimStatus iiwasim_program_load(const char *path,
                                        struct IiwasimProgram **program);

/*
 Frees a program; NULL is left alone. Plans that were made of it stay.
 */
void iiwasim_program_free(struct IiwasimProgram *program);

/*
 The library's version, such as `0.1.0`. It is not to be freed.
 */
const char *iiwasim_version(void);

/*
 Frees a string that a function has written; NULL is left alone.

 # Safety

 `string` is NULL, or was written by this library and not freed yet.
 */
void iiwasim_string_free(char *string);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* IIWASIM_H */
