package com.kuka.roboticsAPI.motionModel.controlModeModel;

/** Stub of the KUKA type: see src/stubs/README.md. */
public class PositionControlMode {
}
