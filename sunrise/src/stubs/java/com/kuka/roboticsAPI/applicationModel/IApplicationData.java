package com.kuka.roboticsAPI.applicationModel;

import com.kuka.roboticsAPI.geometricModel.Tool;

/** Stub of the KUKA type: see src/stubs/README.md. */
public interface IApplicationData {
    Tool createFromTemplate(String name);
}
