package iiwasim.program;

import static org.junit.Assert.assertEquals;
import static org.junit.Assert.assertNull;
import static org.junit.Assert.assertTrue;
import static org.junit.Assert.fail;

import org.junit.Test;

import java.io.ByteArrayInputStream;
import java.io.File;
import java.io.FileInputStream;
import java.io.IOException;

public class SettingsTest {
    private static Settings read(String text) throws IOException {
        return Settings.read(new ByteArrayInputStream(text.getBytes("UTF-8")), "iiwasim.settings");
    }

    private static void assertRefused(String text, String... parts) {
        try {
            read(text);
        } catch (IOException error) {
            for (String part : parts) {
                assertTrue(error.getMessage(), error.getMessage().contains(part));
            }
            return;
        }
        fail(text);
    }

    @Test
    public void everythingHasADefault() throws IOException {
        Settings settings = read("");
        assertEquals("127.0.0.1", settings.address());
        assertEquals(30001, settings.instructionsPort());
        assertEquals(30002, settings.statePort());
        assertNull(settings.keyFile());
        assertEquals(Settings.DRIVE, settings.friClient());
        assertEquals(30200, settings.friPort());
        assertEquals(5, settings.friPeriodMs());
        assertNull(settings.tool());
        assertNull(settings.robot());
        assertTrue(settings.signals().isEmpty());
    }

    @Test
    public void theFileForTheProjectIsReadAndHasThemAll() throws IOException {
        File file = new File("src/sunrise/java/iiwasim/sunrise/iiwasim.settings");
        Settings settings = Settings.read(new FileInputStream(file), file.getName());
        assertEquals("cabinet.key", settings.keyFile());
        assertEquals("0.0.0.0", settings.address());
        assertEquals(11, settings.signals().size());
    }

    @Test
    public void whatIsWrongIsToldWithItsLine() {
        assertRefused(
            "robot = kr16\nflange_mm = 152\n", "line 1", "lbr_iiwa_7_r800 or lbr_iiwa_14_r820");
        assertRefused("robot = lbr_iiwa_7_r800\n", "line 1", "belong together");
        assertRefused("robot = lbr_iiwa_7_r800\nflange_mm = -1\n", "line 2", "length in mm");
        assertRefused("fri_port = 1\n", "line 1", "30200 to 30209");
        assertRefused("# a\n\nspeed = 3 # fast\n", "line 3", "unknown setting `speed`");
        assertRefused("tool = a\ntool = b\n", "line 2", "line 1");
        assertRefused("tool\n", "line 1", "name = value");
        assertRefused("key = cabinet.key\n", "line 1", "`allow`");
        assertRefused("fri_client = robot-pc\n", "line 1", "IPv4");
        assertRefused("fri_client = 192.170.10.256\n", "IPv4");
        assertRefused("state_port = 30001\n", "line 1", "differ");
        assertRefused("fri_period_ms = 50\nfri_receive_multiplier = 3\n", "100 ms");
        for (String signal : new String[] {"input.A = boolean", "input.A.B = word",
            "output.A.B = analog 16",
            "input.A.B = unsigned", "input.A.B = unsigned 65", "output.A.B = analog 16 3 3",
            "output.A.B = analog x 0 1"}) {
            assertRefused("\n" + signal + "\n", "line 2");
        }
    }

    @Test
    public void signalsAreDeclared() throws IOException {
        Settings settings =
            read("output.Gripper.Force = analog 16 0 120.5\ninput.Gripper.Width.Mm = unsigned 8\n");
        Settings.DeclaredSignal force = settings.signals().get(0);
        assertEquals("Gripper", force.group);
        assertEquals("Force", force.name);
        assertTrue(force.isOutput && force.max == 120.5);
        assertEquals("Width.Mm", settings.signals().get(1).name);
    }
}
