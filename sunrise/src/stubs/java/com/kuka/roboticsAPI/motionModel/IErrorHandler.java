package com.kuka.roboticsAPI.motionModel;

import com.kuka.roboticsAPI.deviceModel.Device;
import java.util.List;

/** Stub of the KUKA type: see src/stubs/README.md. */
public interface IErrorHandler {
    ErrorHandlingAction handleError(
        Device device, IMotionContainer failed, List<IMotionContainer> canceled);
}
