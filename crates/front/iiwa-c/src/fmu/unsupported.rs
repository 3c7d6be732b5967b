//! Unsupported functions of FMI 3.0. The standard requires all functions to be present; these
//! return an error.

use std::ffi::{c_char, c_void};

use super::instance::{CallRefusal, FmiStatus, FmuInstance, call};

/// Defines functions with their arguments after the instance, grouped by the missing capability.
macro_rules! unsupported {
    ($($capability:literal: $($name:ident($($argument:ty),*))+;)+) => { $($(
        #[unsafe(no_mangle)]
        extern "C" fn $name(instance: Option<&mut FmuInstance> $(, _: $argument)*) -> FmiStatus {
            call(instance, |_| {
                const REFUSAL: &str =
                    concat!(stringify!($name), ": this FMU has no ", $capability);
                Err(CallRefusal::error(REFUSAL))
            })
        }
    )+)+ };
}

type References = *const u32;

unsupported! {
    "variables of this type":
        fmi3GetFloat32(References, usize, *mut f32, usize)
        fmi3GetInt8(References, usize, *mut i8, usize)
        fmi3GetUInt8(References, usize, *mut u8, usize)
        fmi3GetInt16(References, usize, *mut i16, usize)
        fmi3GetUInt16(References, usize, *mut u16, usize)
        fmi3GetUInt32(References, usize, *mut u32, usize)
        fmi3GetInt64(References, usize, *mut i64, usize)
        fmi3GetUInt64(References, usize, *mut u64, usize)
        fmi3GetString(References, usize, *mut *const c_char, usize)
        fmi3GetBinary(References, usize, *mut usize, *mut *const u8, usize)
        fmi3SetFloat32(References, usize, *const f32, usize)
        fmi3SetInt8(References, usize, *const i8, usize)
        fmi3SetUInt8(References, usize, *const u8, usize)
        fmi3SetInt16(References, usize, *const i16, usize)
        fmi3SetUInt16(References, usize, *const u16, usize)
        fmi3SetInt32(References, usize, *const i32, usize)
        fmi3SetUInt32(References, usize, *const u32, usize)
        fmi3SetInt64(References, usize, *const i64, usize)
        fmi3SetUInt64(References, usize, *const u64, usize)
        fmi3SetString(References, usize, *const *const c_char, usize)
        fmi3SetBinary(References, usize, *const usize, *const *const u8, usize);
    "dependencies of single elements":
        fmi3GetNumberOfVariableDependencies(u32, *mut usize)
        fmi3GetVariableDependencies(u32, *mut usize, *mut u32, *mut usize, *mut i32, usize);
    "states that can be serialised":
        fmi3SerializedFMUStateSize(*mut c_void, *mut usize)
        fmi3SerializeFMUState(*mut c_void, *mut u8, usize)
        fmi3DeserializeFMUState(*const u8, usize, *mut *mut c_void);
    "derivatives":
        fmi3GetDirectionalDerivative(
            References, usize, References, usize, *const f64, usize, *mut f64, usize)
        fmi3GetAdjointDerivative(
            References, usize, References, usize, *const f64, usize, *mut f64, usize)
        fmi3GetOutputDerivatives(References, usize, *const i32, *mut f64, usize);
    "structural parameters":
        fmi3EnterConfigurationMode()
        fmi3ExitConfigurationMode();
    "event mode":
        fmi3EnterEventMode()
        fmi3EnterStepMode()
        fmi3EvaluateDiscreteStates()
        fmi3UpdateDiscreteStates(
            *mut bool, *mut bool, *mut bool, *mut bool, *mut bool, *mut f64);
    "clocks":
        fmi3GetClock(References, usize, *mut bool)
        fmi3SetClock(References, usize, *const bool)
        fmi3GetIntervalDecimal(References, usize, *mut f64, *mut i32)
        fmi3GetIntervalFraction(References, usize, *mut u64, *mut u64, *mut i32)
        fmi3GetShiftDecimal(References, usize, *mut f64)
        fmi3GetShiftFraction(References, usize, *mut u64, *mut u64)
        fmi3SetIntervalDecimal(References, usize, *const f64)
        fmi3SetIntervalFraction(References, usize, *const u64, *const u64)
        fmi3SetShiftDecimal(References, usize, *const f64)
        fmi3SetShiftFraction(References, usize, *const u64, *const u64)
        fmi3ActivateModelPartition(u32, f64);
    "model exchange":
        fmi3EnterContinuousTimeMode()
        fmi3CompletedIntegratorStep(bool, *mut bool, *mut bool)
        fmi3SetTime(f64)
        fmi3SetContinuousStates(*const f64, usize)
        fmi3GetContinuousStateDerivatives(*mut f64, usize)
        fmi3GetEventIndicators(*mut f64, usize)
        fmi3GetContinuousStates(*mut f64, usize)
        fmi3GetNominalsOfContinuousStates(*mut f64, usize)
        fmi3GetNumberOfEventIndicators(*mut usize)
        fmi3GetNumberOfContinuousStates(*mut usize);
}

#[unsafe(no_mangle)]
extern "C" fn fmi3InstantiateModelExchange(
    _instance_name: *const c_char,
    _instantiation_token: *const c_char,
    _resource_path: *const c_char,
    _visible: bool,
    _logging_on: bool,
    _environment: *mut c_void,
    _log: *const c_void,
) -> Option<Box<FmuInstance>> {
    None
}

#[unsafe(no_mangle)]
extern "C" fn fmi3InstantiateScheduledExecution(
    _instance_name: *const c_char,
    _instantiation_token: *const c_char,
    _resource_path: *const c_char,
    _visible: bool,
    _logging_on: bool,
    _environment: *mut c_void,
    _log: *const c_void,
    _clock_update: *const c_void,
    _lock_preemption: *const c_void,
    _unlock_preemption: *const c_void,
) -> Option<Box<FmuInstance>> {
    None
}
