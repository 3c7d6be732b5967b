package com.kuka.roboticsAPI.controllerModel.sunrise;

/** A stub of ours: see src/stubs/README.md. */
public interface SunriseSafetyState {
    /** A stub of ours. */
    enum SafetyStopType { NOSTOP, STOP0, STOP1, STOP2 }
}
