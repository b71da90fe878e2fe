// Answers of the monitor: loading, failed, or outdated.
import { Fragment, h } from "preact";
import { useEffect, useRef, useState } from "preact/hooks";
import { time } from "./format.js";
import { Loader } from "./loader.js";

const NONE = { value: null, error: null, at_ms: null };

// Answer to a request: `key` identifies the request, and it is loaded again when `mark` changes.
export function useAnswer(key, mark, ask) {
  const [got, set] = useState({ key: null, ...NONE });
  const loader = useRef(null), latest = useRef(ask);
  latest.current = ask;
  useEffect(() => {
    const own = loader.current = new Loader(() => latest.current(), state => set({ key, ...state }));
    return () => own.end();
  }, [key]);
  useEffect(() => { loader.current.load(); }, [key, mark]);
  const state = got.key === key ? got : NONE;
  return { ...state, retry: () => loader.current.load() };
}

// In place of an answer that is missing yet.
export function Missing({ answer, title, what }) {
  if (!answer.error) return <p class="loading" role="status">Loading {what} …</p>;
  return (
    <>
      {title && <h1 tabindex="-1">{title}</h1>}
      <p class="error" role="alert">{answer.error.message} <button onClick={answer.retry}>Retry</button></p>
    </>
  );
}

// Above an answer that could not be updated.
export function Outdated({ answer }) {
  if (!answer.error || answer.value === null) return null;
  return (
    <p class="banner alarm" role="status"><strong>Not updated since {time(answer.at_ms / 1000)}:</strong> {answer.error.message}{" "}
      <button onClick={answer.retry}>Retry</button></p>
  );
}
