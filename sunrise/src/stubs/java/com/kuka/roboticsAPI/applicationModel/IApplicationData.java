package com.kuka.roboticsAPI.applicationModel;

import com.kuka.roboticsAPI.geometricModel.Tool;

/** A stub of ours: see src/stubs/README.md. */
public interface IApplicationData {
    Tool createFromTemplate(String name);
}
