package com.kuka.roboticsAPI.motionModel.controlModeModel;

/** A stub of ours: see src/stubs/README.md. */
public class PositionControlMode {
}
