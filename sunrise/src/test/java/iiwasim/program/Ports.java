package iiwasim.program;

import java.io.File;
import java.io.FileNotFoundException;
import java.io.IOException;
import java.net.DatagramSocket;
import java.net.InetAddress;
import java.net.ServerSocket;
import java.util.ArrayList;
import java.util.LinkedList;
import java.util.List;
import java.util.Random;
import java.util.Scanner;

/** Unused ports, each given out once, from the same blocks as in {@code tests/src/ports.rs}. */
public final class Ports {
    private static final int FIRST = 10000;
    private static final int END = 30000;
    private static final int BLOCK = 50;

    /**
     * UDP sockets at the beginning of blocks: their owner has the other ports of the block until it
     * ends.
     */
    private static final List<DatagramSocket> GUARDS = new ArrayList<DatagramSocket>();

    /**
     * First ports of blocks not tried yet; blocks in the range of outgoing connections are last.
     */
    private static LinkedList<Integer> untried;
    private static int next;
    private static int end;

    private Ports() {
    }

    public static synchronized int free() throws IOException {
        while (true) {
            while (next < end) {
                int port = next++;
                if (isFree(port)) {
                    return port;
                }
            }
            takeBlock();
        }
    }

    private static void takeBlock() throws IOException {
        if (untried == null) {
            untried = blocks();
        }
        if (untried.isEmpty()) {
            throw new IOException("there is no free port");
        }
        int begin = untried.removeFirst();
        try {
            GUARDS.add(new DatagramSocket(begin, InetAddress.getByName("127.0.0.1")));
        } catch (IOException error) {
            // Another process owns the block.
            return;
        }
        next = begin + 1;
        end = begin + BLOCK;
    }

    private static LinkedList<Integer> blocks() {
        int[] outgoing = outgoing();
        LinkedList<Integer> blocks = new LinkedList<Integer>();
        LinkedList<Integer> last = new LinkedList<Integer>();
        int count = (END - FIRST) / BLOCK;
        int from = new Random().nextInt(count);
        for (int i = 0; i < count; i++) {
            int begin = FIRST + BLOCK * ((from + i) % count);
            boolean isOutgoing = begin + BLOCK > outgoing[0] && begin <= outgoing[1];
            (isOutgoing ? last : blocks).add(begin);
        }
        blocks.addAll(last);
        return blocks;
    }

    /** The first and the last port of the system for outgoing connections. */
    private static int[] outgoing() {
        try {
            Scanner range = new Scanner(new File("/proc/sys/net/ipv4/ip_local_port_range"));
            try {
                return new int[] {range.nextInt(), range.nextInt()};
            } finally {
                range.close();
            }
        } catch (FileNotFoundException error) {
            return new int[] {49152, 65535};
        }
    }

    /** True if the port is unused, also by programs that do not use blocks. */
    private static boolean isFree(int port) throws IOException {
        InetAddress here = InetAddress.getByName("127.0.0.1");
        try {
            new ServerSocket(port, 1, here).close();
            new DatagramSocket(port, here).close();
            return true;
        } catch (IOException error) {
            return false;
        }
    }
}
