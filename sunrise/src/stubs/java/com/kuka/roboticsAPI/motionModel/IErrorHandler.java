package com.kuka.roboticsAPI.motionModel;

import com.kuka.roboticsAPI.deviceModel.Device;
import java.util.List;

/** A stub of ours: see src/stubs/README.md. */
public interface IErrorHandler {
    ErrorHandlingAction handleError(Device device, IMotionContainer failed, List<IMotionContainer> canceled);
}
