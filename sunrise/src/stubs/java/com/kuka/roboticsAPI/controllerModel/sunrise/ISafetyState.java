package com.kuka.roboticsAPI.controllerModel.sunrise;

/** Stub of the KUKA type: see src/stubs/README.md. */
public interface ISafetyState {
    SunriseSafetyState.SafetyStopType getSafetyStopSignal();
}
