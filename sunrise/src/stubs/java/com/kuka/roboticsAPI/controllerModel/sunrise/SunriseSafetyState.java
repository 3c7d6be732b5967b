package com.kuka.roboticsAPI.controllerModel.sunrise;

/** Stub of the KUKA type: see src/stubs/README.md. */
public interface SunriseSafetyState {
    /** Stub of the KUKA type. */
    enum SafetyStopType { NOSTOP, STOP0, STOP1, STOP2 }
}
