// The connection to sweepd. The browser connects again by itself; where it gives up, this does.
import { say } from "./text.js";

const SILENCE_MS = 6000;
const AGAIN_MS = 1000;
const place = document.getElementById("connection");

export function connection(state, text) {
  if (place.dataset.state !== state) place.dataset.state = state;
  say(place, text);
}

/**
 * Calls `handlers[event](data)` for each event of a robot. `hello` comes first whenever it is live
 * again: then all begins anew. `lost_since(moment)` is called while it is not, with when it was last.
 */
export function listen(robot, handlers, lost_since) {
  const url = "/api/live?robot=" + encodeURIComponent(robot);
  let source = null;
  let heard = performance.now();
  let lost = false;
  let told = null;
  let timer = 0;

  const lose = (why) => {
    lost = true;
    connection("lost", why);
    if (told) lost_since(told);
  };

  const explain = async () => {
    try {
      const stop = new AbortController();
      const answer = await fetch(url, { signal: stop.signal, headers: { Accept: "text/event-stream" } });
      if (answer.ok) stop.abort();
      else lose(`sweepd says: ${(await answer.text()).trim()}. This page tries again by itself.`);
    } catch {
      lose("The connection to sweepd is lost. This page tries again by itself.");
    }
  };

  const connect = () => {
    clearTimeout(timer);
    heard = performance.now();
    source = new EventSource(url);
    for (const [event, handle] of Object.entries(handlers))
      source.addEventListener(event, (message) => {
        heard = performance.now();
        told = new Date();
        if (event === "hello") connection("live", lost ? "live again" : "live");
        handle(JSON.parse(message.data));
      });
    source.onerror = () => {
      if (source.readyState === EventSource.CLOSED) {
        explain();
        timer = setTimeout(connect, AGAIN_MS);
      } else {
        lose("The connection to sweepd is lost. This page tries again by itself.");
      }
    };
  };

  connect();
  setInterval(() => {
    if (performance.now() - heard < SILENCE_MS || source.readyState === EventSource.CLOSED) return;
    lose("sweepd has not told anything for some seconds. This page tries again by itself.");
    source.close();
    connect();
  }, 1000);
}
