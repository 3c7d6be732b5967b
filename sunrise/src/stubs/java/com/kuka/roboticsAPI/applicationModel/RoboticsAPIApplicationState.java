package com.kuka.roboticsAPI.applicationModel;

/** Stub of the KUKA type: see src/stubs/README.md. */
public enum RoboticsAPIApplicationState {
    STOPPING, MOTIONPAUSING, RESUMING
}
