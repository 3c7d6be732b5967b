package com.kuka.roboticsAPI.deviceModel;

/** Stub of the KUKA type: see src/stubs/README.md. */
public enum OperationMode {
    T1, T2, AUT
}
