package com.kuka.roboticsAPI.applicationModel;

/** A stub of ours: see src/stubs/README.md. */
public enum RoboticsAPIApplicationState {
    STOPPING, MOTIONPAUSING, RESUMING
}
