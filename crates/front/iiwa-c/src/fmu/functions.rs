//! Supported functions of FMI 3.0, with the names of the standard.

use std::{
    ffi::{c_char, c_void},
    mem::MaybeUninit,
};

use super::{
    instance::{CallRefusal, FmiStatus, FmuInstance, LogMessage, Logger, Mode, Snapshot, call},
    model::{FmuModel, Misuse},
    variables::Variable,
};
use crate::{failure::CallFailure, pointers};

type Instance<'a> = Option<&'a mut FmuInstance>;

#[unsafe(no_mangle)]
extern "C" fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

#[unsafe(no_mangle)]
extern "C" fn fmi3SetDebugLogging(
    instance: Instance<'_>,
    _logging_on: bool,
    _n_categories: usize,
    _categories: *const *const c_char,
) -> FmiStatus {
    // The FMU logs errors only, and always.
    call(instance, |_| Ok(()))
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3InstantiateCoSimulation(
    _instance_name: *const c_char,
    instantiation_token: *const c_char,
    resource_path: *const c_char,
    _visible: bool,
    _logging_on: bool,
    event_mode_used: bool,
    _early_return_allowed: bool,
    _required_intermediate_variables: *const u32,
    n_required_intermediate_variables: usize,
    environment: *mut c_void,
    log: Option<LogMessage>,
    _intermediate_update: *const c_void,
) -> Option<Box<FmuInstance>> {
    let arguments = || {
        if event_mode_used || n_required_intermediate_variables > 0 {
            let message = "this FMU has neither an event mode nor intermediate variables";
            return Err(CallFailure::argument(message));
        }
        // SAFETY: the standard requires strings that end with a NUL, or NULL; they are read before
        // the call returns.
        let token = unsafe { pointers::text(instantiation_token, "the instantiation token") }?;
        // SAFETY: likewise.
        let path = unsafe { pointers::text(resource_path, "the path of the resources") }?;
        Ok((token, path))
    };
    FmuInstance::new(arguments, Logger { environment, log })
}

#[unsafe(no_mangle)]
extern "C" fn fmi3FreeInstance(instance: Option<Box<FmuInstance>>) {
    drop(instance);
}

#[unsafe(no_mangle)]
extern "C" fn fmi3EnterInitializationMode(
    instance: Instance<'_>,
    _tolerance_defined: bool,
    _tolerance: f64,
    start_time: f64,
    _stop_time_defined: bool,
    _stop_time: f64,
) -> FmiStatus {
    call(instance, |instance| {
        instance.is_in(Mode::Instantiated)?;
        instance.model.begin(start_time)?;
        instance.change(Mode::Instantiated, Mode::Initialization)
    })
}

#[unsafe(no_mangle)]
extern "C" fn fmi3ExitInitializationMode(instance: Instance<'_>) -> FmiStatus {
    call(instance, |instance| instance.change(Mode::Initialization, Mode::Step))
}

#[unsafe(no_mangle)]
extern "C" fn fmi3Terminate(instance: Instance<'_>) -> FmiStatus {
    call(instance, |instance| instance.change(Mode::Step, Mode::Terminated))
}

#[unsafe(no_mangle)]
extern "C" fn fmi3Reset(instance: Instance<'_>) -> FmiStatus {
    call(instance, |instance| {
        instance.model.reset();
        instance.mode = Mode::Instantiated;
        Ok(())
    })
}

#[unsafe(no_mangle)]
extern "C" fn fmi3DoStep(
    instance: Instance<'_>,
    current_communication_point: f64,
    communication_step_size: f64,
    _no_set_fmu_state_prior_to_current_point: bool,
    event_handling_needed: Option<&mut MaybeUninit<bool>>,
    terminate_simulation: Option<&mut MaybeUninit<bool>>,
    early_return: Option<&mut MaybeUninit<bool>>,
    last_successful_time: Option<&mut MaybeUninit<f64>>,
) -> FmiStatus {
    call(instance, |instance| {
        instance.is_in(Mode::Step)?;
        instance.model.step(current_communication_point, communication_step_size)?;
        for answer in [event_handling_needed, terminate_simulation, early_return] {
            answer.map(|place| place.write(false));
        }
        let now_s = current_communication_point + communication_step_size;
        last_successful_time.map(|place| place.write(now_s));
        Ok(())
    })
}

#[unsafe(no_mangle)]
extern "C" fn fmi3GetFMUState(
    instance: Instance<'_>,
    state: Option<&mut Option<Box<Snapshot>>>,
) -> FmiStatus {
    call(instance, |instance| {
        let state = state.ok_or_else(|| CallRefusal::error("the place of the state is NULL"))?;
        match state {
            Some(state) => **state = instance.snapshot(),
            None => *state = Some(Box::new(instance.snapshot())),
        }
        Ok(())
    })
}

#[unsafe(no_mangle)]
extern "C" fn fmi3SetFMUState(instance: Instance<'_>, state: Option<&Snapshot>) -> FmiStatus {
    call(instance, |instance| {
        instance.restore(*state.ok_or_else(|| CallRefusal::error("the state is NULL"))?);
        Ok(())
    })
}

#[unsafe(no_mangle)]
extern "C" fn fmi3FreeFMUState(
    instance: Instance<'_>,
    state: Option<&mut Option<Box<Snapshot>>>,
) -> FmiStatus {
    call(instance, |_| {
        drop(state.and_then(Option::take));
        Ok(())
    })
}

/// Returns the variables of value references.
///
/// # Safety
///
/// See [`pointers::values`].
unsafe fn variables<'a>(
    references: *const u32,
    count: usize,
    values: usize,
) -> Result<impl Iterator<Item = Result<Variable, CallRefusal>> + 'a, CallRefusal> {
    if values != count {
        let message = format!("{values} values for {count} variables, which have one each");
        return Err(CallRefusal::error(message));
    }
    // SAFETY: the caller gives the same guarantee.
    let references: &'a [u32] = unsafe { pointers::values(references, count, "the references") }?;
    Ok(references.iter().map(|&reference| {
        Variable::of(reference).ok_or_else(|| {
            CallRefusal::error(format!("no variable has the value reference {reference}"))
        })
    }))
}

/// Writes the values of variables to an array.
///
/// # Safety
///
/// `references` has `count` entries, and `values` has room for `n_values` values.
unsafe fn get<T>(
    instance: Instance<'_>,
    (references, count): (*const u32, usize),
    (values, n_values): (*mut T, usize),
    value: impl Fn(&FmuModel, Variable) -> Option<T>,
) -> FmiStatus {
    call(instance, |instance| {
        // SAFETY: the caller gives the same guarantee.
        let variables = unsafe { variables(references, count, n_values) }?;
        // SAFETY: likewise.
        let places = unsafe { pointers::places(values, n_values, "the values") }?;
        for (place, variable) in places.iter_mut().zip(variables) {
            let variable = variable?;
            place.write(value(&instance.model, variable).ok_or_else(|| {
                let name = variable.declaration().name;
                CallRefusal::error(format!(
                    "{name} is of another type than the one that is asked for"
                ))
            })?);
        }
        Ok(())
    })
}

/// Sets variables.
///
/// # Safety
///
/// `references` has `count` entries, and `values` has `n_values`.
unsafe fn set<T: Copy>(
    instance: Instance<'_>,
    (references, count): (*const u32, usize),
    (values, n_values): (*const T, usize),
    set: impl Fn(&mut FmuModel, Variable, T) -> Result<(), Misuse>,
) -> FmiStatus {
    call(instance, |instance| {
        if instance.mode == Mode::Terminated {
            return Err(CallRefusal::error("a variable is set after the end of the simulation"));
        }
        // SAFETY: the caller gives the same guarantee.
        let variables = unsafe { variables(references, count, n_values) }?;
        // SAFETY: likewise.
        let values = unsafe { pointers::values(values, n_values, "the values") }?;
        for (&value, variable) in values.iter().zip(variables) {
            set(&mut instance.model, variable?, value)?;
        }
        Ok(())
    })
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3GetFloat64(
    instance: Instance<'_>,
    references: *const u32,
    count: usize,
    values: *mut f64,
    n_values: usize,
) -> FmiStatus {
    // SAFETY: the standard requires these array lengths.
    unsafe { get(instance, (references, count), (values, n_values), FmuModel::float64) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3GetInt32(
    instance: Instance<'_>,
    references: *const u32,
    count: usize,
    values: *mut i32,
    n_values: usize,
) -> FmiStatus {
    // SAFETY: the standard requires these array lengths.
    unsafe { get(instance, (references, count), (values, n_values), FmuModel::int32) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3GetBoolean(
    instance: Instance<'_>,
    references: *const u32,
    count: usize,
    values: *mut bool,
    n_values: usize,
) -> FmiStatus {
    // SAFETY: the standard requires these array lengths.
    unsafe { get(instance, (references, count), (values, n_values), FmuModel::boolean) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3SetFloat64(
    instance: Instance<'_>,
    references: *const u32,
    count: usize,
    values: *const f64,
    n_values: usize,
) -> FmiStatus {
    // SAFETY: the standard requires these array lengths.
    unsafe { set(instance, (references, count), (values, n_values), FmuModel::set_float64) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn fmi3SetBoolean(
    instance: Instance<'_>,
    references: *const u32,
    count: usize,
    // Read as bytes: a `bool` with any value other than 0 and 1 is undefined behaviour.
    values: *const u8,
    n_values: usize,
) -> FmiStatus {
    let boolean = |model: &mut FmuModel, variable, byte| model.set_boolean(variable, byte != 0);
    // SAFETY: the standard requires these array lengths.
    unsafe { set(instance, (references, count), (values, n_values), boolean) }
}
