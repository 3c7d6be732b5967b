package com.kuka.connectivity.fastRobotInterface;

/** A stub of ours: see src/stubs/README.md. */
public enum ClientCommandMode {
    POSITION, WRENCH, TORQUE
}
