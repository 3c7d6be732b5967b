package iiwasim.sunrise;

import com.kuka.roboticsAPI.controllerModel.Controller;
import com.kuka.roboticsAPI.ioModel.AbstractIOGroup;
import com.kuka.roboticsAPI.ioModel.IOTypes;

import iiwasim.program.Refusal;
import iiwasim.program.Settings.DeclaredSignal;
import iiwasim.program.Settings.SignalType;
import iiwasim.program.Signal;
import iiwasim.program.SignalValue;

import java.util.ArrayList;
import java.util.LinkedHashMap;
import java.util.List;
import java.util.Map;

/**
 * Inputs and outputs declared in the settings, by the names of their groups, without generated
 * classes.
 */
final class IoGroups {
    /** Maximum number of readings of an output, whose new value is visible with a delay. */
    private static final int LOOKS = 10;
    private static final long LOOK_MS = 50;

    private final Map<String, Group> groups = new LinkedHashMap<String, Group>();
    private final List<DeclaredSignal> signals;

    IoGroups(Controller controller, List<DeclaredSignal> signals) {
        this.signals = signals;
        for (DeclaredSignal signal : signals) {
            Group group = groups.get(signal.group);
            if (group == null) {
                group = new Group(controller, signal.group);
                groups.put(signal.group, group);
            }
            group.declare(signal);
        }
    }

    /** An I/O group of the cabinet. */
    private static final class Group extends AbstractIOGroup {
        Group(Controller controller, String name) {
            super(controller, name);
        }

        void declare(DeclaredSignal signal) {
            IOTypes type = signal.type == SignalType.BOOLEAN ? IOTypes.BOOLEAN
                : signal.type == SignalType.INTEGER ? IOTypes.INTEGER
                : signal.type == SignalType.UNSIGNED ? IOTypes.UNSIGNED_INTEGER : IOTypes.ANALOG;
            if (!signal.isOutput) {
                addInput(signal.name, type, signal.bits);
            } else if (signal.type == SignalType.ANALOG) {
                addAnalogOutput(signal.name, type, signal.bits, signal.min, signal.max);
            } else {
                addDigitalOutput(signal.name, type, signal.bits);
            }
        }

        SignalValue read(DeclaredSignal signal) {
            switch (signal.type) {
                case BOOLEAN:
                    return SignalValue.of(getBooleanIOValue(signal.name, signal.isOutput));
                case ANALOG:
                    return SignalValue.of(getAnalogIOValue(signal.name, signal.isOutput));
                default:
                    long value = getNumberIOValue(signal.name, signal.isOutput).longValue();
                    return value < 0 ? SignalValue.of((double) value) : SignalValue.of(value);
            }
        }

        void write(DeclaredSignal signal, SignalValue value) {
            switch (signal.type) {
                case BOOLEAN:
                    setDigitalOutput(signal.name, value.truth());
                    break;
                case ANALOG:
                    setAnalogOutput(signal.name, value.number());
                    break;
                default:
                    setDigitalOutput(signal.name, Long.valueOf((long) value.number()));
            }
        }
    }

    /** All inputs and outputs with their values. */
    List<Signal> all() throws Refusal {
        List<Signal> all = new ArrayList<Signal>();
        for (DeclaredSignal signal : signals) {
            all.add(new Signal(signal.group + "." + signal.name, signal.isOutput, value(signal)));
        }
        return all;
    }

    private SignalValue value(DeclaredSignal signal) throws Refusal {
        try {
            return groups.get(signal.group).read(signal);
        } catch (RuntimeException error) {
            throw Refusal.robot("the input or output " + signal.group + "." + signal.name
                + " cannot be read; does the station's I/O configuration have it? "
                + error.getMessage());
        }
    }

    SignalValue get(String name) throws Refusal {
        return value(signal(name));
    }

    SignalValue set(String name, SignalValue value) throws Refusal {
        DeclaredSignal signal = signal(name);
        check(signal, name, value);
        try {
            groups.get(signal.group).write(signal, value);
        } catch (RuntimeException error) {
            throw Refusal.robot(name + " cannot be set: " + error.getMessage());
        }
        SignalValue now = value(signal);
        for (int i = 0; i < LOOKS && !isSame(now, value); i++) {
            try {
                Thread.sleep(LOOK_MS);
            } catch (InterruptedException interrupt) {
                Thread.currentThread().interrupt();
                break;
            }
            now = value(signal);
        }
        return now;
    }

    private static void check(DeclaredSignal signal, String name, SignalValue value)
        throws Refusal {
        if (!signal.isOutput) {
            throw Refusal.bad(name + " is an input; it cannot be set");
        }
        if (signal.type == SignalType.BOOLEAN) {
            if (value.truth() == null) {
                throw Refusal.bad(name + " takes true or false, not " + value);
            }
            return;
        }
        if (value.truth() != null) {
            throw Refusal.bad(name + " takes a number, not " + value);
        }
        double number = value.number();
        if (signal.type == SignalType.ANALOG) {
            range(name, number, signal.min, signal.max);
            return;
        }
        if (number != Math.rint(number)) {
            throw Refusal.bad(name + " takes a whole number, not " + value);
        }
        boolean isSigned = signal.type == SignalType.INTEGER;
        double half = Math.pow(2, signal.bits - 1);
        range(name, number, isSigned ? -half : 0, (isSigned ? half : 2 * half) - 1);
    }

    private static void range(String name, double number, double min, double max) throws Refusal {
        if (!(number >= min && number <= max)) {
            throw Refusal.bad(
                name + " takes a number from " + min + " to " + max + ", not " + number);
        }
    }

    private static boolean isSame(SignalValue a, SignalValue b) {
        return a.truth() != null ? a.truth().equals(b.truth())
            : Math.abs(a.number() - b.number()) < 1e-3;
    }

    private DeclaredSignal signal(String name) throws Refusal {
        List<Signal> known = new ArrayList<Signal>();
        for (DeclaredSignal signal : signals) {
            if (name.equals(signal.group + "." + signal.name)) {
                return signal;
            }
            known.add(new Signal(
                signal.group + "." + signal.name, signal.isOutput, SignalValue.of(false)));
        }
        Signal.find(known, name);
        throw new IllegalStateException("it was not found twice");
    }
}
