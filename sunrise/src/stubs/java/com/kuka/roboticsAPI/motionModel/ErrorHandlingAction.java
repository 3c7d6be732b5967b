package com.kuka.roboticsAPI.motionModel;

/** A stub of ours: see src/stubs/README.md. */
public enum ErrorHandlingAction {
    Ignore, PauseMotion, EndApplication
}
