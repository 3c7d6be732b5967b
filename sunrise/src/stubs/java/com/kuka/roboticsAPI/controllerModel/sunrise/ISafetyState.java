package com.kuka.roboticsAPI.controllerModel.sunrise;

/** A stub of ours: see src/stubs/README.md. */
public interface ISafetyState {
    SunriseSafetyState.SafetyStopType getSafetyStopSignal();
}
