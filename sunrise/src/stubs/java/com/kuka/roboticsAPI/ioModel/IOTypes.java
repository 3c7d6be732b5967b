package com.kuka.roboticsAPI.ioModel;

/** Stub of the KUKA type: see src/stubs/README.md. */
public enum IOTypes {
    BOOLEAN, INTEGER, UNSIGNED_INTEGER, ANALOG
}
